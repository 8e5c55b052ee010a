/// Reference (oracle) for the evaluation of planners. It selects views by their ground-truth
/// visibility. It is not part of survey/ because planners must not know the ground truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "geometry/pose/pose.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_record.h"
#include "sim/sensors/depth_camera.h"
#include "survey/surfel/coverage_model.h"

namespace skycap::missions::simulation {

/// Returns the noise of a simulated camera as described by the coverage model.
survey::surfel::Noise true_noise(const sim::NoiseConfig& noise);

struct OmniscientConfig {
  std::size_t candidates = 1500;  ///< Number of candidate views, each aimed at a visible position.
  std::size_t samples = 8000;     ///< Number of surface samples for evaluating candidates.
  /// Fraction of the surface at which the selection ends. If empty, it ends when no view adds at
  /// least `options.oracle.min_gain` of the visible surface.
  std::optional<double> target_coverage;
};

/// Returns the views selected by survey_omnisciently() in tour order. Nothing is measured unless
/// `target_coverage` is set.
std::vector<geometry::View> known_cover(const evaluation::SimulationOptions& options,
                                        const evaluation::SurveyScene& scene, std::uint64_t seed,
                                        unsigned threads, const OmniscientConfig& config = {});

/// Surveys the mission's scene with full knowledge of it: a greedy cover of the surface by the
/// candidates, starting with the mission's first view for `seed`, flown along a short open tour.
/// The coverage of an observation follows from the true noise (survey/dose_model.h). Results are
/// measured by the simulated sensor and stored at the mission's spacing.
///
/// `record.views` is in tour order. Greedy cover and tour are not optimal. The number of views and
/// the distance are therefore upper bounds on those of the best survey. The mission's limits apply.
/// Throws all errors of the sensor.
session::SurveyRecord survey_omnisciently(const evaluation::SimulationOptions& options,
                                          const evaluation::SurveyScene& scene, std::uint64_t seed,
                                          unsigned threads, const OmniscientConfig& config = {},
                                          std::stop_token stop = {});

}  // namespace skycap::missions::simulation
