/// What a survey will take, as far as one can tell before it.
#pragma once

#include <cstddef>

#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::simulation {

struct Expectation {
  std::size_t known_views = 0;  ///< of one who knows the scene: known_cover() by few candidates
  std::size_t least_views = 0;  ///< times what the mission's planner took in surveys of other
  std::size_t most_views = 0;   ///< scenes, at least and at most; within the mission's limits
  double least_minutes = 0.0;   ///< of the flight, by speeds, ways and stops
  double most_minutes = 0.0;
  double memory = 0.0;      ///< of the whole program [byte], by triangles, pixels and points
  double least_time = 0.0;  ///< of this machine [s]: the first view, measured and planned,
  double most_time = 0.0;   ///< times the views
};

/// Takes a few seconds: samples of the surface seen from some hundred views, and one view of the
/// survey. Only of a feasible mission. Throws what planner and sensor throw.
Expectation expectation(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run);

}  // namespace skycap::missions::simulation
