/// The sensor's noise, learnt from its scans.
#pragma once

#include <array>
#include <map>
#include <optional>

#include "survey/skycap/block_image.h"
#include "survey/skycap/dose_model.h"

namespace skycap::survey::skycap {

/// Each block's residual (block_image.h) is the noise across the surface, plus curvature. Smooth
/// places show the noise alone: the estimate is the lower quartile over the blocks of a scan,
/// separately for four ranges of incidence, and the least of all scans. What falls with the cosine
/// of incidence is noise along the ray; what does not is isotropic:
/// sigma^2(theta) = isotropic^2 + along_ray^2 cos^2(theta).
///
/// The same quartiles by depth, of residuals over the cosine, tell whether noise grows with range:
/// sigma^2(z) = a + b z^4, along the ray. It counts as growing only where depths twice as far apart
/// were seen, the farther ones are clearly noisier, and the law fits all of them: relief does not.
class NoiseEstimate {
 public:
  void add(const BlockImage& image);

  /// Nothing until a scan held enough smooth surface; then the estimate so far, at `depth` if it
  /// grows with range. Below `negligible`, twice as far away, it is zero.
  std::optional<Noise> noise(double negligible, double depth) const;

 private:
  static constexpr int range_count = 4;  // of the cosine, from one half to one
  struct VarianceAt {
    double variance, depth;
  };

  void add_by_depth(const BlockImage& image);
  std::optional<Noise> constant_noise() const;
  void let_grow(Noise& noise, double depth) const;

  std::array<std::optional<double>, range_count> least_variance_;
  std::map<int, VarianceAt> by_depth_;  ///< the least, and of what depth; by half octaves
};

}  // namespace skycap::survey::skycap
