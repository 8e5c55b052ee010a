/// Reachability results for the views proposed after a scan. They are recorded because path
/// planning is expensive: a resumed survey obtains the same results without planning.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "geometry/pose/pose.h"
#include "missions/session/survey_flight.h"

namespace skycap::missions::session {

struct ReachRecord {
  std::size_t rejected = 0;   ///< Number of unreachable proposals.
  bool is_reached = false;    ///< True if a reachable proposal was found.
  ExecutedLeg path;           ///< Path to the reachable view, for surveys with a vehicle.
  std::size_t unreached = 0;  ///< Value of SurveyFlight::rejected() after these proposals.
};

/// Convert a record to and from its journal entry. parse_reach() throws exceptions of
/// nlohmann::json.
nlohmann::ordered_json reach_json(const ReachRecord& record);
ReachRecord parse_reach(const nlohmann::ordered_json& json);

/// Records whether views are reachable and replays recorded results.
class ReachabilityCache {
 public:
  using CanReach = std::function<bool(const Eigen::Vector3d& from, const geometry::View& to)>;

  /// Starts the proposals after the next scan. `known` is the recorded result of an earlier run.
  void begin(std::optional<ReachRecord> known);

  /// Returns a function that replays known results and otherwise calls `can_reach`. `flight` may be
  /// null. `flight` and this object must outlive the returned function.
  CanReach remembering(CanReach can_reach, SurveyFlight* flight);

  /// Returns the results since begin().
  const ReachRecord& record() const { return record_; }

 private:
  bool known_answer(SurveyFlight* flight);

  std::optional<ReachRecord> known_;
  ReachRecord record_;
};

}  // namespace skycap::missions::session
