/// Check of a mission for impossible settings before a run.
#pragma once

#include <string>
#include <vector>

#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::simulation {

/// Results as complete sentences, each with a remedy.
struct Feasibility {
  std::vector<std::string> problems;  ///< Problems that prevent the survey.
  /// Conditions under which the result is probably not as intended.
  std::vector<std::string> warnings;
};

/// Compares the mission's distances with its scene, takes a first scan, and searches for positions
/// with visible surface. Takes about as long as one or two views.
Feasibility feasibility(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run);

/// Throws Error{bad_config} with all problems, if any.
void require_feasible(const evaluation::SimulationOptions& options,
                      const evaluation::SurveyScene& scene, const session::RunOptions& run);

}  // namespace skycap::missions::simulation
