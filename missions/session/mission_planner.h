/// A mission's planner with all that has a say in where it may look from: the mission's limits, and
/// the ways that its vehicle can prove. The same for simulated and live surveys.
#pragma once

#include <memory>
#include <optional>

#include "geometry/place/pose.h"
#include "missions/session/survey_flight.h"
#include "missions/session/survey_options.h"
#include "missions/session/survey_record.h"
#include "survey/planner.h"
#include "survey/planners/planner_options.h"
#include "survey/survey_loop.h"

namespace skycap::missions::session {

class MissionPlanner {
 public:
  /// Only a mission with a vehicle needs to know the first view. Throws what survey::make_planner()
  /// and SurveyFlight throw.
  MissionPlanner(const SurveyOptions& options, const std::optional<geometry::View>& first_view,
                 const survey::PlannerRun& run);
  ~MissionPlanner();

  survey::Planner& planner();

  /// Null without a vehicle.
  SurveyFlight* flight();

  /// `opening`, and `sensed`, `can_reach` and what goes with them, which refer to this object.
  survey::SurveyPorts ports();

  survey::SurveyLimits limits() const;

  /// What the planner holds and believes at present; the flight is not in it.
  void tell(SurveyRecord& record) const;

  /// Hands over the cloud, the flight, and what the planner believes at the end. Nothing else may
  /// be called afterwards.
  void finish(SurveyRecord& record);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::missions::session
