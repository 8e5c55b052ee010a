/// The sensor's noise, learnt from its scans.
#pragma once

#include <array>
#include <optional>

#include "survey/skycap/block_image.h"
#include "survey/skycap/dose_model.h"

namespace skycap::survey::skycap {

/// Each block's residual (block_image.h) is the noise across the surface, plus curvature. Smooth
/// places show the noise alone: the estimate is the lower quartile over the blocks of a scan,
/// separately for four ranges of incidence, and the least of all scans. What falls with the cosine
/// of incidence is noise along the ray; what does not is isotropic:
/// sigma^2(theta) = isotropic^2 + along_ray^2 cos^2(theta).
class NoiseEstimate {
 public:
  void add(const BlockImage& image);

  /// Nothing until a scan held enough smooth surface; then the estimate so far. Below `negligible`
  /// it is zero.
  std::optional<Noise> noise(double negligible) const;

 private:
  static constexpr int range_count = 4;  // of the cosine, from one half to one
  std::array<std::optional<double>, range_count> least_variance_;
};

}  // namespace skycap::survey::skycap
