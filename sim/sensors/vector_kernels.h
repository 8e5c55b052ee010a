/// The arithmetic that every pixel or shot goes through, compiled once for each vector instruction
/// set and chosen at run time. All interfaces are plain arrays, because Eigen types must not cross
/// between sources with different instruction sets.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/sensors/noise.h"

namespace skycap::sim {

/// One image row of a pinhole camera. A pixel's ray is `column + row` in each axis, in world axes
/// and with depth 1; its return is `origin + depth * ray`.
struct PinholeRow {
  std::size_t width;
  const float* depth;      ///< along the optical axis; negative: no return
  const float* column[3];  ///< x, y and z of each column's part of the ray
  float row[3];            ///< this row's part
  float origin[3];         ///< world frame
  std::uint32_t first_pixel;

  float sigma;  ///< standard deviation of the noise [m]
  NoiseDirection noise_direction;
  NoiseKey noise_keys[3];     ///< x, y, z; along the ray only the first is used
  std::uint32_t noise_index;  ///< of the row's first pixel, a multiple of 32
};

/// What the functions below compute for one instruction set.
struct VectorKernels {
  void (*fill_normals)(const NoiseKey& key, std::uint32_t first, float* normals, std::size_t count);
  /// Writes x, y, z and pixel number of each return of the row, one after the other; gives their
  /// number. There must be room for `width` of them.
  std::size_t (*emit_row)(const PinholeRow& row, float* points, std::uint32_t* pixels);
};

extern const VectorKernels baseline_kernels;
#ifdef SKYCAP_X86_64_KERNELS
extern const VectorKernels avx2_kernels;
extern const VectorKernels avx512_kernels;
#endif

/// Those for geometry::instruction_set().
const VectorKernels& vector_kernels();

}  // namespace skycap::sim
