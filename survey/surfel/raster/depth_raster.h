/// Depth buffer of a view, for occlusion tests.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "survey/surfel/raster/visibility_kernels.h"

namespace skycap::survey::surfel {

/// Depth image of points drawn as squares. The memory is reused; use one object per thread.
class DepthRaster {
 public:
  /// Draws points as squares with the edge length 2 * `spacing`. A square has four pixels at depths
  /// of at least focal length * spacing. At smaller depths it has more pixels, so that surface
  /// behind the points stays hidden.
  void draw(const RasterView& view, std::size_t count, const PointArrays& points, float spacing);

  /// Returns the depth of the nearest square [m], or infinity where no square is drawn.
  float depth(std::uint32_t pixel) const { return depths_[pixel]; }

 private:
  static constexpr std::size_t chunk =
      2048;  // points processed at a time, so that their arrays fit into the cache

  /// Pixel plane with additional rows of infinite depth above and below, as many as the windows
  /// need.
  using Plane = std::vector<float>;
  struct Square {
    std::uint32_t pixel;
    float depth;
    int size;
  };

  void draw_chunk(const RasterView& view, const PointArrays& points, std::size_t count,
                  float spacing);
  void draw_square(const RasterView& view, const Square& square);

  /// Nearest depth per point pixel, by width of the squares. Infinite between calls.
  std::array<Plane, largest_window + 1> nearest_;
  std::array<bool, largest_window + 1> is_used_{};
  Plane row_wise_;
  int stride_ = 0;  ///< stride of the planes; 0 if they must be reallocated
  std::vector<float> depths_;
  std::vector<Square> large_;  ///< squares too wide for windows

  std::array<std::uint32_t, chunk> pixels_{}, inside_{};
  std::array<float, chunk> chunk_depths_{};
  std::array<std::int32_t, chunk> sizes_{};
};

}  // namespace skycap::survey::surfel
