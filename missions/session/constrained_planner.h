/// Planner of a mission, combined with the mission's limits on views and with the paths that its
/// vehicle can verify. Used by simulated and live surveys.
#pragma once

#include <memory>
#include <optional>

#include "geometry/pose/pose.h"
#include "missions/session/survey_flight.h"
#include "missions/session/survey_options.h"
#include "missions/session/survey_record.h"
#include "survey/planner.h"
#include "survey/planners/planner_options.h"
#include "survey/survey_loop.h"

namespace skycap::missions::session {

class ConstrainedPlanner {
 public:
  /// `first_view` is required only for missions with a vehicle. Throws all errors of
  /// survey::make_planner() and SurveyFlight.
  ConstrainedPlanner(const SurveyOptions& options, const std::optional<geometry::View>& first_view,
                     const survey::PlannerRun& run);
  ~ConstrainedPlanner();

  survey::Planner& planner();

  /// Returns null for missions without a vehicle.
  SurveyFlight* flight();

  /// Returns `initial_pattern`, and for missions with a vehicle also `sensed`, `can_reach` and
  /// related ports. The ports refer to this object.
  survey::SurveyCallbacks callbacks();

  survey::SurveyLimits limits() const;

  /// Copies the planner's current cloud and estimate to `record`, without the flight.
  void fill_record(SurveyRecord& record) const;

  /// Moves the cloud, the flight and the planner's final estimate to `record`. No other member
  /// function may be called afterwards.
  void finish(SurveyRecord& record);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::missions::session
