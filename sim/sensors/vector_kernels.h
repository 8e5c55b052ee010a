/// Per-pixel and per-pulse arithmetic, compiled once per vector instruction set and selected at run
/// time. All interfaces are plain arrays, because Eigen types must not cross between sources with
/// different instruction sets.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/sensors/noise.h"

namespace skycap::sim {

/// One image row of a pinhole camera. A pixel's ray is `column + row` per axis, in world axes and
/// with depth 1. Its return is `origin + depth * ray`.
struct PinholeRow {
  std::size_t width;
  const float* depth;      ///< Depth along the optical axis [m]. Negative: no return.
  const float* column[3];  ///< x, y and z of the column vectors.
  float row[3];            ///< Row vector.
  float origin[3];         ///< World frame [m].
  std::uint32_t first_pixel;

  float sigma;  ///< Standard deviation of the noise [m].
  NoiseDirection noise_direction;
  NoiseKey noise_keys[3];     ///< Keys for x, y and z. Noise along the ray uses only the first.
  std::uint32_t noise_index;  ///< Noise index of the row's first pixel, a multiple of 32.
};

/// Kernels of one instruction set.
struct VectorKernels {
  void (*fill_normals)(const NoiseKey& key, std::uint32_t first, float* normals, std::size_t count);
  /// Writes coordinates and pixel numbers of all returns of the row. Returns their number. The
  /// arrays must have space for `width` returns.
  std::size_t (*emit_row)(const PinholeRow& row, float* points, std::uint32_t* pixels);
};

extern const VectorKernels baseline_kernels;
#ifdef SKYCAP_X86_64_KERNELS
extern const VectorKernels avx2_kernels;
extern const VectorKernels avx512_kernels;
#endif

/// Returns the kernels for geometry::instruction_set().
const VectorKernels& vector_kernels();

}  // namespace skycap::sim
