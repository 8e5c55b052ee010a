/// Calibration of a planner's coverage estimate. It is reliable if a fraction p of the surface
/// estimated as covered with probability p is covered.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "geometry/surfaces/mesh.h"
#include "survey/surfel/survey_estimate.h"

namespace skycap::missions::evaluation {

/// Reliability diagram of the estimate. All fractions refer to the samples that count.
struct Reliability {
  struct Band {
    double estimated = 0.0;  ///< mean estimated probability
    double covered = 0.0;    ///< covered fraction of the band
    double share = 0.0;      ///< fraction of the surface in this band
  };
  static constexpr std::size_t bands_count = 10;

  std::array<Band, bands_count> bands{};  ///< bands of the probability: 0 to 0.1, 0.1 to 0.2, ...
  double unknown_share = 0.0;             ///< fraction of the surface without an estimate
  double unknown_covered = 0.0;           ///< covered fraction of the surface without an estimate
  /// Expected calibration error: mean absolute difference between `estimated` and `covered`,
  /// weighted by `share`.
  double error = 0.0;
};

/// Compares the estimate with the samples marked in `counts`, or with all samples if it is empty.
/// The estimate of a sample is that of the nearest patch facing its side within `reach` [m].
/// `is_covered` is 1 for each covered sample.
Reliability reliability(std::span<const survey::surfel::EstimatedPatch> estimate,
                        const geometry::SurfaceSamples& samples,
                        std::span<const std::uint8_t> is_covered,
                        std::span<const std::uint8_t> counts, double reach);

}  // namespace skycap::missions::evaluation
