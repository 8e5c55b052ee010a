/// The reference that planners are measured against. It knows the truth, which no planner may: it
/// picks views by what they really see, and is therefore no planner and not in survey/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "geometry/place/pose.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_record.h"

namespace skycap::missions::simulation {

struct OmniscientConfig {
  std::size_t candidates = 1500;  ///< views that it picks from, each aimed at a visible place
  std::size_t samples = 8000;     ///< of the surface, that candidates are weighed by
  /// Ends when the measurements cover this share of the surface. Nothing: when no view promises
  /// `options.oracle.least_gain` of the visible surface any more.
  std::optional<double> wanted_coverage;
};

/// Views that cover the scene for one who knows it, in the order of the tour; see
/// survey_omnisciently(), which takes them. Nothing is measured unless a coverage is wanted.
std::vector<geometry::View> known_cover(const evaluation::SimulationOptions& options,
                                        const evaluation::SurveyScene& scene, std::uint64_t seed,
                                        unsigned threads, const OmniscientConfig& config = {});

/// Surveys the mission's scene knowing all of it: from the mission's first view with that seed, a
/// greedy cover of the surface by the candidates, flown along a short open tour. How much of a
/// place a look covers follows from the true noise (survey/dose_model.h); what is reported was
/// measured by the simulated sensor and stored at the mission's spacing.
///
/// `record.views` is in the order of the tour. Greedy covers are not optimal, and neither is the
/// tour, so this bounds the best possible survey from above. Keeps the mission's limits. Throws
/// what the sensor throws.
session::SurveyRecord survey_omnisciently(const evaluation::SimulationOptions& options,
                                          const evaluation::SurveyScene& scene, std::uint64_t seed,
                                          unsigned threads, const OmniscientConfig& config = {},
                                          std::stop_token stop = {});

}  // namespace skycap::missions::simulation
