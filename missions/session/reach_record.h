/// What came of the views that were proposed after a scan. Ways are dear to find and so are written
/// down: a survey that is continued gives the same answers again without looking for them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "geometry/place/pose.h"
#include "missions/session/survey_flight.h"

namespace skycap::missions::session {

struct ReachRecord {
  std::size_t refused = 0;    ///< proposals that could not be reached
  bool is_reached = false;    ///< whether one was found that can be
  FlownLeg way;               ///< to it, with a vehicle
  std::size_t unreached = 0;  ///< SurveyFlight::refused() by then
};

/// As it stands in a journal, and back. parse_reach() throws nlohmann's exceptions.
nlohmann::ordered_json reach_json(const ReachRecord& record);
ReachRecord parse_reach(const nlohmann::ordered_json& json);

/// Answers whether views can be reached, and remembers it.
class ReachMemory {
 public:
  using CanReach = std::function<bool(const Eigen::Vector3d& from, const geometry::View& to)>;

  /// Before the proposals after another scan; `known` is what came of them in an earlier run.
  void begin(std::optional<ReachRecord> known);

  /// Asks `can_reach` what is not known. `flight` may be null; both outlive the answer's use.
  CanReach remembering(CanReach can_reach, SurveyFlight* flight);

  /// What has come of the proposals since begin().
  const ReachRecord& record() const { return record_; }

 private:
  bool known_answer(SurveyFlight* flight);

  std::optional<ReachRecord> known_;
  ReachRecord record_;
};

}  // namespace skycap::missions::session
