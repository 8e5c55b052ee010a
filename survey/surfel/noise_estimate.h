/// Estimation of the sensor noise from scans.
#pragma once

#include <array>
#include <map>
#include <optional>

#include "survey/surfel/block_image.h"
#include "survey/surfel/coverage_model.h"

namespace skycap::survey::surfel {

/// The residual of each block (block_image.h) is the noise across the surface plus curvature.
/// Smooth surfaces show only noise, so the estimate is the lower quartile over the blocks of a
/// scan. It is computed for four ranges of incidence, and the minimum over all scans is used. Noise
/// along the ray decreases with the cosine of incidence, isotropic noise does not: sigma^2(theta) =
/// isotropic^2 + along_ray^2 cos^2(theta).
///
/// The same quartiles by depth, of residual over cosine, show whether noise grows with range:
/// sigma^2(z) = a + b z^4, along the ray. Noise is considered growing only under three conditions,
/// which relief does not meet. Depths differ at least by a factor of two, the farther ones are
/// clearly noisier, and the law fits all depths.
class NoiseEstimate {
 public:
  void add(const BlockImage& image);

  /// Returns the current estimate, at `depth` if it grows with range, or nullopt until a scan had
  /// enough smooth surface. Returns zero if the noise is below `negligible` even at twice the
  /// depth.
  std::optional<Noise> noise(double negligible, double depth) const;

 private:
  static constexpr int range_count = 4;  // ranges of the cosine of incidence from 0.5 to 1
  struct VarianceAt {
    double variance, depth;
  };

  void add_by_depth(const BlockImage& image);
  std::optional<Noise> constant_noise() const;
  void let_grow(Noise& noise, double depth) const;

  std::array<std::optional<double>, range_count> min_variance_;
  std::map<int, VarianceAt> by_depth_;  ///< minimum variance and its depth, by half octave of depth
};

}  // namespace skycap::survey::surfel
