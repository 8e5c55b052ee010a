/// Predicted cost of a survey.
#pragma once

#include <cstddef>

#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::simulation {

struct Expectation {
  /// Number of views of the oracle: known_cover() with few candidates.
  std::size_t known_views = 0;
  /// Min number of views: `known_views` times the min ratio of the mission's planner in other
  /// surveys.
  std::size_t min_views = 0;
  /// Max number of views, from the max ratio. Both are within the mission's limits.
  std::size_t max_views = 0;
  double min_minutes = 0.0;  ///< Min flight time from speeds, paths and stops [min].
  double max_minutes = 0.0;
  double memory = 0.0;  ///< of the whole program [byte], by triangles, pixels and points
  /// Time of a plan on this machine without loading the scene [s], see planning_time.h. The visible
  /// surface and the attainable coverage are cached: another plan of the scene needs less time.
  double min_time = 0.0;
  double max_time = 0.0;
};

/// Predicts the cost of a feasible mission. Takes a few seconds: it evaluates surface samples from
/// some hundred views, and runs the beginning of the survey. Throws all errors of planner, sensor
/// and session::SurveyFlight.
Expectation expectation(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run);

}  // namespace skycap::missions::simulation
