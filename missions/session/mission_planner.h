/// A mission's planner with all that has a say in where it may look from: the mission's limits, and
/// the ways that its vehicle can prove. The same for simulated and live surveys.
#pragma once

#include <memory>
#include <optional>

#include "geometry/place/pose.h"
#include "missions/config/mission.h"
#include "missions/session/survey_flight.h"
#include "missions/session/survey_record.h"
#include "survey/planner.h"
#include "survey/survey_loop.h"

namespace skycap::missions::session {

class MissionPlanner {
 public:
  /// On so many threads (zero: all processors). Only a mission with a vehicle needs to know the
  /// first view. Throws what config::make_planner() and SurveyFlight throw.
  MissionPlanner(const config::Mission& mission, const std::optional<geometry::View>& first_view,
                 unsigned threads);
  ~MissionPlanner();

  survey::Planner& planner();

  /// Null without a vehicle.
  SurveyFlight* flight();

  /// `opening`, and `sensed`, `can_reach` and what goes with them, which refer to this object.
  survey::SurveyPorts ports();

  survey::SurveyLimits limits() const;

  /// What the planner holds and believes at present; the flight is not in it.
  void tell(SurveyRecord& record) const;

  /// Hands over the cloud, the flight, and what the planner believes at the end; it may turn out to
  /// have stopped for another reason than the record's. Nothing else may be called afterwards.
  void finish(SurveyRecord& record);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::missions::session
