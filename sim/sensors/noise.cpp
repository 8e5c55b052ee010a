#include "sim/sensors/noise.h"

#include <cassert>
#include <cmath>

#include "geometry/requirement.h"
#include "geometry/split_mix.h"
#include "sim/sensors/vector_kernels.h"

namespace skycap::sim {
NoiseKey noise_key(std::uint64_t seed, std::uint32_t stream, std::uint64_t frame) {
  const std::uint64_t radius =
      geometry::split_mix(geometry::split_mix(geometry::split_mix(seed) ^ frame) ^ stream);
  const std::uint64_t angle = geometry::split_mix(radius);
  return {{static_cast<std::uint32_t>(radius), static_cast<std::uint32_t>(radius >> 32),
           static_cast<std::uint32_t>(angle), static_cast<std::uint32_t>(angle >> 32)}};
}

void fill_normals(const NoiseKey& key, std::uint32_t first, std::span<float> normals) {
  assert(first % 32 == 0);
  vector_kernels().fill_normals(key, first, normals.data(), normals.size());
}

void NoiseConfig::validate() const {
  require(sigma >= 0.0 && std::isfinite(sigma), "noise.sigma", sigma, "zero or more metres");
  table.validate("noise.table");
}

}  // namespace skycap::sim
