/// Body of vector_kernels_*.cpp, which define SKYCAP_KERNELS_NAME and include it once each. Those
/// sources are compiled for different processors, so all content of this file is internal to them.
/// Inline functions of libraries must not be called, because the linker would keep an arbitrary
/// copy. Loops contain no branches or calls, so that the compiler vectorises them.
///
/// Contraction to fused multiply-adds is off (sim/CMakeLists.txt), so all instruction sets give
/// identical bits.

#include <cstddef>
#include <cstdint>

#include "sim/sensors/vector_kernels.h"

namespace skycap::sim {
namespace {

constexpr std::size_t block = 32;  // Block of normal variates: `half` Box-Muller pairs.
constexpr std::size_t half = block / 2;

inline float as_float(std::uint32_t bits) { return __builtin_bit_cast(float, bits); }
inline std::uint32_t as_bits(float value) { return __builtin_bit_cast(std::uint32_t, value); }
inline float as_signed_float(std::uint32_t bits) {
  return static_cast<float>(static_cast<std::int32_t>(bits));
}

// Two hashes of an index, selected by the key. The first is a bijection of 32-bit words. Its
// multipliers and shifts are close to those with the least avalanche bias in C. Wellons' "hash
// prospector" search. A further round gives the second.
struct Hashes {
  std::uint32_t radius, angle;
};
inline Hashes hash(const NoiseKey& key, std::uint32_t spread_index) {
  std::uint32_t x = spread_index ^ key.words[0];
  x = (x ^ (x >> 16)) * 0x7FEB352DU;
  x = ((x + key.words[1]) ^ (x >> 15)) * 0x846CA68BU;
  x = x ^ (x >> 16);
  std::uint32_t y = (x + key.words[2]) * 0x9E3779B1U;
  y = ((y ^ (y >> 15)) + key.words[3]) * 0x2C1B3C6DU;
  return {x, y ^ (y >> 16)};
}

// Returns -2 ln((h + 1/2) / 2^31) for the upper 31 bits h of `bits`, at least 0. The logarithm is
// split into exponent and mantissa in [sqrt(1/2), sqrt(2)). The polynomial error is below 3e-6.
inline float minus_two_log_uniform(std::uint32_t bits) {
  const std::uint32_t uniform = as_bits(as_signed_float(bits >> 1) * 0x1p-31F + 0x1p-32F);
  constexpr std::uint32_t root_half = 0x3F3504F3U;
  const auto exponent = static_cast<std::int32_t>(uniform - root_half) >> 23;
  const float x = as_float(uniform - (static_cast<std::uint32_t>(exponent) << 23)) - 1.0F;
  float p = -0.24002491F;
  p = p * x + 0.36779218F;
  p = p * x - 0.40755764F;
  p = p * x + 0.49881868F;
  p = p * x - 0.66648285F;
  p = p * x + 1.00000654F;
  const float value = (p * x - 2.0F) * x - 1.38629436F * static_cast<float>(exponent);
  return value > 0.0F ? value : 0.0F;
}

// Multiplies `radius` by cosine and sine of a uniform angle. The angle phi is uniform in one
// quarter turn. Exchanging and negating sine and cosine moves it to one of the four quarters.
inline void scatter(float radius, std::uint32_t angle_bits, float& first, float& second) {
  const float phi = as_signed_float(angle_bits) * 3.65721684e-10F;  // pi/4 / 2^31.
  const float y = phi * phi;
  const float sine = phi + phi * y * (0.00821185551F * y - 0.16665731F);
  const float cosine = 1.0F + y * ((-0.00136611670F * y + 0.0416614106F) * y - 0.499999820F);
  const float signed_radius = as_float(as_bits(radius) ^ ((angle_bits << 30) & 0x80000000U));
  const std::uint32_t exchange = 0U - (angle_bits & 1U);
  const std::uint32_t difference = (as_bits(sine) ^ as_bits(cosine)) & exchange;
  first = signed_radius * as_float(as_bits(cosine) ^ difference);
  second = signed_radius * as_float(as_bits(sine) ^ difference);
}

// Computes `blocks` blocks of normal variates, the i-th from keys[i] and firsts[i], a multiple of
// 32. Each step is a loop over all pairs. A single pair is a long chain of dependent operations, so
// the processor needs other pairs to work on in parallel.
template <std::size_t blocks>
inline void normal_blocks(const NoiseKey* const (&keys)[blocks],
                          const std::uint32_t (&firsts)[blocks], float (&normals)[blocks][block]) {
  // Odd, so that neighbouring indices differ in all bits.
  constexpr std::uint32_t spread = 0x9E3779B1U;
  std::uint32_t radius_bits[blocks * half], angle_bits[blocks * half];
  float radius[blocks * half];
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::uint32_t first_pair = (firsts[b] >> 1) * spread;
    for (std::uint32_t lane = 0; lane < half; ++lane) {
      const auto [for_radius, for_angle] = hash(*keys[b], first_pair + lane * spread);
      radius_bits[b * half + lane] = for_radius;
      angle_bits[b * half + lane] = for_angle;
    }
  }
  for (std::size_t i = 0; i < blocks * half; ++i) {
    radius[i] = __builtin_sqrtf(minus_two_log_uniform(radius_bits[i]));
  }
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t lane = 0; lane < half; ++lane) {
      scatter(radius[b * half + lane], angle_bits[b * half + lane], normals[b][lane],
              normals[b][lane + half]);
    }
  }
}

void fill_normals_kernel(const NoiseKey& key, std::uint32_t first, float* normals,
                         std::size_t count) {
  constexpr std::size_t blocks = 4, batch = blocks * block;
  for (std::size_t done = 0; done < count; done += batch) {
    const auto start = static_cast<std::uint32_t>(first + done);
    float some[blocks][block];
    normal_blocks<blocks>({&key, &key, &key, &key}, {start, start + 32U, start + 64U, start + 96U},
                          some);
    const std::size_t rest = count - done;
    __builtin_memcpy(normals + done, some, (rest < batch ? rest : batch) * sizeof(float));
  }
}

// Computes coordinates of up to 32 pixels from `start` on, regardless of returns.
inline void block_points(const PinholeRow& row, std::size_t start, std::size_t count,
                         float (&xyz)[3][block]) {
  const bool noisy = row.sigma > 0.0F;
  const std::uint32_t index = row.noise_index + static_cast<std::uint32_t>(start);
  float depth[block];
  float ray[3][block];
  for (std::size_t i = 0; i < count; ++i) depth[i] = row.depth[start + i];
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) {
      ray[axis][i] = row.column[axis][start + i] + row.row[axis];
    }
  }
  if (noisy && row.noise_direction == NoiseDirection::along_ray) {
    float normals[1][block];
    normal_blocks<1>({&row.noise_keys[0]}, {index}, normals);
    for (std::size_t i = 0; i < count; ++i) {
      const float length =
          __builtin_sqrtf(ray[0][i] * ray[0][i] + ray[1][i] * ray[1][i] + ray[2][i] * ray[2][i]);
      depth[i] += row.sigma * normals[0][i] / length;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) {
      xyz[axis][i] = row.origin[axis] + depth[i] * ray[axis][i];
    }
  }
  if (noisy && row.noise_direction == NoiseDirection::isotropic) {
    float normals[3][block];
    normal_blocks<3>({&row.noise_keys[0], &row.noise_keys[1], &row.noise_keys[2]},
                     {index, index, index}, normals);
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < count; ++i) xyz[axis][i] += row.sigma * normals[axis][i];
    }
  }
}

std::size_t emit_row_kernel(const PinholeRow& row, float* points, std::uint32_t* pixels) {
  std::size_t written = 0;
  for (std::size_t start = 0; start < row.width; start += block) {
    const std::size_t count = row.width - start < block ? row.width - start : block;
    const std::uint32_t first_pixel = row.first_pixel + static_cast<std::uint32_t>(start);
    std::uint32_t misses = 0;
    for (std::size_t i = 0; i < count; ++i) misses += as_bits(row.depth[start + i]) >> 31;
    if (misses == count) continue;

    float xyz[3][block];
    float* out = points + 3 * written;
    if (misses == 0 && count == block) {
      block_points(row, start, block, xyz);
      for (std::size_t i = 0; i < block; ++i) {
        out[3 * i] = xyz[0][i];
        out[3 * i + 1] = xyz[1][i];
        out[3 * i + 2] = xyz[2][i];
      }
      for (std::size_t i = 0; i < block; ++i) {
        pixels[written + i] = first_pixel + static_cast<std::uint32_t>(i);
      }
      written += block;
      continue;
    }
    block_points(row, start, count, xyz);
    for (std::size_t i = 0; i < count; ++i) {
      if (row.depth[start + i] < 0.0F) continue;
      points[3 * written] = xyz[0][i];
      points[3 * written + 1] = xyz[1][i];
      points[3 * written + 2] = xyz[2][i];
      pixels[written++] = first_pixel + static_cast<std::uint32_t>(i);
    }
  }
  return written;
}

}  // namespace

const VectorKernels SKYCAP_KERNELS_NAME = {fill_normals_kernel, emit_row_kernel};

}  // namespace skycap::sim
