/// Whether a planner's belief can be relied on: of the surface that it believes covered with
/// probability p, p should be.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "geometry/surfaces/mesh.h"
#include "survey/skycap/survey_belief.h"

namespace skycap::missions::evaluation {

/// The true surface by what was believed of it; shares are of the samples that count.
struct Reliability {
  struct Band {
    double believed = 0.0;  ///< mean probability
    double covered = 0.0;   ///< share that is
    double share = 0.0;     ///< of the surface
  };
  static constexpr std::size_t bands_count = 10;

  std::array<Band, bands_count> bands{};  ///< of probabilities from 0 to 0.1, 0.1 to 0.2, ...
  double unknown_share = 0.0;             ///< of the surface, which the planner knows nothing of
  double unknown_covered = 0.0;           ///< share of that which is covered
  /// Mean distance of believed from covered over the bands, weighted by their shares.
  double error = 0.0;
};

/// Each sample that `counts` marks (all if that is empty) is believed what the nearest of the
/// patches says that face its way, no farther than `reach` from it. `is_covered` is 1 for each
/// sample that is.
Reliability reliability(std::span<const survey::skycap::BelievedPatch> belief,
                        const geometry::SurfaceSamples& samples,
                        std::span<const std::uint8_t> is_covered,
                        std::span<const std::uint8_t> counts, double reach);

}  // namespace skycap::missions::evaluation
