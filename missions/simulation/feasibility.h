/// What of a mission cannot work, and what to do about it: said before anything runs.
#pragma once

#include <string>
#include <vector>

#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::simulation {

/// Whole sentences, each with its remedy.
struct Feasibility {
  std::vector<std::string> problems;  ///< with which no survey begins
  std::vector<std::string> warnings;  ///< with which one will hardly be what was meant
};

/// Compares the mission's distances with its scene, takes a first scan, and looks for places that
/// see something. Takes about as long as a view or two.
Feasibility feasibility(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run);

/// Throws Error{bad_config} with all problems, if there are any.
void require_feasible(const evaluation::SimulationOptions& options,
                      const evaluation::SurveyScene& scene, const session::RunOptions& run);

}  // namespace skycap::missions::simulation
