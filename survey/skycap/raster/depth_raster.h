/// How deep a view looks before points hide what is behind them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "survey/skycap/raster/sight_kernels.h"

namespace skycap::survey::skycap {

/// A depth image of points that stand for squares. Its memory is used again: one for each thread.
class DepthRaster {
 public:
  /// Points that stand for squares of twice `spacing`: of four pixels at the depth of
  /// focal_length times spacing and beyond, and of more nearer, lest what is behind shine through.
  void draw(const RasterView& view, std::size_t count, const PointArrays& points, float spacing);

  /// Of the nearest square [m]; infinite where there is none.
  float depth(std::uint32_t pixel) const { return depths_[pixel]; }

 private:
  static constexpr std::size_t chunk = 2048;  // points at a time: their arrays stay in the cache

  /// A plane with as many rows beside it as windows reach: pixels of it, and infinite depths
  /// around.
  using Plane = std::vector<float>;
  struct Square {
    std::uint32_t pixel;
    float depth;
    int size;
  };

  void draw_chunk(const RasterView& view, const PointArrays& points, std::size_t count,
                  float spacing);
  void draw_square(const RasterView& view, const Square& square);

  /// By the width of squares: the nearest of them in their points' pixels. Infinite between calls.
  std::array<Plane, largest_window + 1> nearest_;
  std::array<bool, largest_window + 1> is_used_{};
  Plane row_wise_;
  int stride_ = 0;  ///< of the planes; 0: they are to be made anew
  std::vector<float> depths_;
  std::vector<Square> large_;  ///< too wide for windows

  std::array<std::uint32_t, chunk> pixels_{}, inside_{};
  std::array<float, chunk> chunk_depths_{};
  std::array<std::int32_t, chunk> sizes_{};
};

}  // namespace skycap::survey::skycap
