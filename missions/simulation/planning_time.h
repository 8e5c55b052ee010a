/// Predicted computing time of `skycap plan`, from counted work and measured times of parts of it.
#pragma once

#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::simulation {

/// Predicted work of a survey.
struct SurveyWork {
  double scans = 0.0;   ///< including en-route scans
  double points = 0.0;  ///< stored points
};

/// Times of parts of a plan, measured on this machine [s].
struct PlanningPace {
  double start = 0.0;           ///< until the first view of the survey has been planned
  double scan = 0.0;            ///< a further scan of the survey, with planning and evaluation
  double measurement = 0.0;     ///< simulation of a scan and evaluation of its coverage
  double visible = 0.0;         ///< the visible surface
  double attainable = 0.0;      ///< the attainable coverage: minimum
  double max_attainable = 0.0;  ///< the attainable coverage: maximum
};

/// Runs the begin of the survey for a few seconds, and counts the views for the attainable coverage
/// with a sample of the surface. Throws all errors of planner, sensor and session::SurveyFlight.
PlanningPace measure_pace(const evaluation::SimulationOptions& options,
                          const evaluation::SurveyScene& scene, const session::RunOptions& run);

/// Returns the time of a plan without loading the scene [s].
double planning_time(const PlanningPace& pace, const SurveyWork& work, double attainable,
                     bool has_vehicle);

}  // namespace skycap::missions::simulation
