#include "sim/sensors/noise.h"

#include <cassert>
#include <cmath>

#include "geometry/requirement.h"
#include "sim/sensors/vector_kernels.h"

namespace skycap::sim {
namespace {

// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): a bijection with full avalanche.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ x >> 27) * 0x94D049BB133111EBULL;
  return x ^ x >> 31;
}

}  // namespace

NoiseKey noise_key(std::uint64_t seed, std::uint32_t stream, std::uint64_t frame) {
  const std::uint64_t radius = mix(mix(mix(seed) ^ frame) ^ stream);
  const std::uint64_t angle = mix(radius);
  return {{static_cast<std::uint32_t>(radius), static_cast<std::uint32_t>(radius >> 32),
           static_cast<std::uint32_t>(angle), static_cast<std::uint32_t>(angle >> 32)}};
}

void fill_normals(const NoiseKey& key, std::uint32_t first, std::span<float> normals) {
  assert(first % 32 == 0);
  vector_kernels().fill_normals(key, first, normals.data(), normals.size());
}

void NoiseConfig::validate() const {
  require(sigma >= 0.0 && std::isfinite(sigma), "sensor.noise.sigma", sigma, "zero or more metres");
}

}  // namespace skycap::sim
