/// Random numbers for measurement errors: standard normals that are a pure function of a key and
/// an index. A sensor keys them by (seed, stream, frame) and indexes them by pixel or shot, so a
/// scan has the same bits for any number of threads, tile size and processor.
///
/// Construction: an integer hash of the index gives two uniforms, the Box-Muller transform of
/// which gives two normals: those of indices `i` and `i + 16` of the same block of 32. Only
/// correctly rounded operations are used, and none is contracted, hence the same bits everywhere.
/// The polynomials make the normals' radius exact to 3e-6 and their angle to 6e-6. The largest
/// normal that can occur is 6.7.
#pragma once

#include <cstdint>
#include <span>

namespace skycap::sim {

/// Names one sequence of 2^32 normals. Sequences of different keys are unrelated.
struct NoiseKey {
  std::uint32_t words[4];
};

/// The key of one stream of a frame: `stream` tells apart what a sensor draws for each shot (x, y
/// and z of isotropic noise, say), `frame` its scans.
NoiseKey noise_key(std::uint64_t seed, std::uint32_t stream, std::uint64_t frame);

/// Writes to `normals[i]` the standard normal of index `first + i`. `first` must be a multiple
/// of 32. Costs about 0.5 ns each with AVX-512.
void fill_normals(const NoiseKey& key, std::uint32_t first, std::span<float> normals);

/// How a sensor's points scatter.
enum class NoiseDirection {
  isotropic,  ///< independently along x, y and z
  along_ray,  ///< in distance only
};

/// Gaussian noise of constant size: the sensor error of the SEE++ experiments, in which normals
/// of standard deviation 0.01 m are added to the observed points (paper §IV-A). The paper's words
/// fit both directions.
struct NoiseConfig {
  double sigma = 0.0;  ///< standard deviation; zero gives exact points
  NoiseDirection direction = NoiseDirection::isotropic;
  std::uint64_t seed = 0;

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

}  // namespace skycap::sim
