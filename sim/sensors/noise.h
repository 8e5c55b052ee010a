/// Random numbers for measurement errors: standard normal variates as a pure function of key and
/// index. A sensor uses the key (seed, stream, frame) and the pixel or pulse as index. A scan is
/// therefore bit-identical for any number of threads, tile size and processor.
///
/// Method: an integer hash of the index gives two uniform variates. The Box-Muller transform
/// converts them to two normal variates, those of indices `i` and `i + 16` in a block of 32. Only
/// correctly rounded operations without contraction are used, which makes results identical on all
/// processors. The polynomials are exact to 3e-6 for the radius and 6e-6 for the angle. The largest
/// possible variate is 6.7.
#pragma once

#include <cstdint>
#include <span>

#include "sim/sensors/noise_table.h"

namespace skycap::sim {

/// Key of a sequence of 2^32 normal variates. Sequences with different keys are uncorrelated.
struct NoiseKey {
  std::uint32_t words[4];
};

/// Returns the key of one stream of a frame. `stream` distinguishes the variates of a pulse (such
/// as x, y and z of isotropic noise), `frame` the scans.
NoiseKey noise_key(std::uint64_t seed, std::uint32_t stream, std::uint64_t frame);

/// Writes the standard normal variate of index `first + i` to `normals[i]`. `first` must be a
/// multiple of 32. Takes about 0.5 ns per variate with AVX-512.
void fill_normals(const NoiseKey& key, std::uint32_t first, std::span<float> normals);

/// Direction of point noise.
enum class NoiseDirection {
  isotropic,  ///< Independent along x, y and z.
  along_ray,  ///< Along the ray only.
};

/// Gaussian noise of constant magnitude, as in the SEE++ experiments, which add normal errors with
/// a standard deviation of 0.01 m to the points (paper §IV-A). The paper's wording permits both
/// directions.
struct NoiseConfig {
  double sigma = 0.0;  ///< Standard deviation [m]. 0: exact points.
  NoiseDirection direction = NoiseDirection::isotropic;
  std::uint64_t seed = 0;
  NoiseTable table = {};  ///< Additional noise along the ray.

  /// Throws Error{bad_config} naming the first field outside its interval.
  void validate() const;
};

}  // namespace skycap::sim
