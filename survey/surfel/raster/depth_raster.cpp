#include "survey/surfel/raster/depth_raster.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace skycap::survey::surfel {
namespace {

constexpr float nothing = std::numeric_limits<float>::infinity();

/// Returns the offset of the first pixel of a plane.
std::size_t compute_margin(const RasterView& view) {
  return static_cast<std::size_t>(row_margin) * static_cast<std::size_t>(view.stride);
}

}  // namespace

void DepthRaster::draw(const RasterView& view, std::size_t count, const PointArrays& points,
                       float spacing) {
  // The stride is invalid until the end, so that planes are reset after an exception.
  const int stride = std::exchange(stride_, 0);
  if (depths_.size() != view.outside || stride != view.stride) {
    const std::size_t with_margins = view.outside + 2 * compute_margin(view);
    for (Plane& plane : nearest_) plane.assign(with_margins, nothing);
    row_wise_.assign(with_margins, nothing);
    depths_.resize(view.outside);
  }
  is_used_.fill(false);
  large_.clear();
  for (std::size_t first = 0; first < count; first += chunk) {
    draw_chunk(view, {points.x + first, points.y + first, points.z + first},
               std::min(chunk, count - first), spacing);
  }
  std::ranges::fill(depths_, nothing);
  for (int size = 2; size <= largest_window; ++size) {
    if (!is_used_[static_cast<std::size_t>(size)]) continue;
    float* const nearest = nearest_[static_cast<std::size_t>(size)].data() + compute_margin(view);
    draw_squares(view, size, nearest, row_wise_.data() + compute_margin(view), depths_.data());
  }
  for (const Square& square : large_) draw_square(view, square);
  stride_ = view.stride;
}

void DepthRaster::draw_chunk(const RasterView& view, const PointArrays& points, std::size_t count,
                             float spacing) {
  project_points(view, count, points, spacing,
                 {pixels_.data(), chunk_depths_.data(), sizes_.data()});
  // Uses values instead of references and branches, because the depth order is unpredictable.
  const std::uint32_t outside = view.outside;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    inside_[inside] = static_cast<std::uint32_t>(i);
    inside += pixels_[i] != outside ? 1 : 0;
  }
  std::array<float*, largest_window + 1> planes{};
  std::array<bool, largest_window + 1> is_used = is_used_;
  for (std::size_t size = 2; size < planes.size(); ++size) {
    planes[size] = nearest_[size].data() + compute_margin(view);
  }
  for (std::size_t k = 0; k < inside; ++k) {
    const std::size_t i = inside_[k];
    const float depth = chunk_depths_[i];
    if (sizes_[i] > largest_window) {
      large_.push_back({pixels_[i], depth, sizes_[i]});
      continue;
    }
    const auto size = static_cast<std::size_t>(sizes_[i]);
    is_used[size] = true;
    float* const pixel = planes[size] + pixels_[i];
    const float before = *pixel;
    *pixel = depth < before ? depth : before;
  }
  is_used_ = is_used;
}

void DepthRaster::draw_square(const RasterView& view, const Square& square) {
  const int rows = static_cast<int>(view.outside) / view.stride;
  const auto pixel = static_cast<int>(square.pixel);
  const int row = pixel / view.stride - pixels_before_square(square.size);
  const int column = pixel % view.stride - pixels_before_square(square.size);
  const int end = std::min(view.stride, column + square.size);
  for (int r = std::max(0, row); r < std::min(rows, row + square.size); ++r) {
    for (int c = std::max(0, column); c < end; ++c) {
      float& nearest = depths_[static_cast<std::size_t>(r) * view.stride + c];
      nearest = std::min(nearest, square.depth);
    }
  }
}

}  // namespace skycap::survey::surfel
