#include "survey/surfel/spaced_cloud.h"

#include <algorithm>
#include <array>
#include <vector>

namespace skycap::survey::surfel {
namespace {

using Eigen::Vector3f;
using geometry::ScanSpan;

constexpr std::uint32_t tile_px = 32;
constexpr std::size_t sweep_chunk = 4096;  // returns without an image per thread and step

/// Calls `visit` for each return of a row of tiles with its index and its column in the tile.
/// Returns are visited tile by tile, so that consecutive returns are close to each other. Returns
/// without an image are visited in their order.
template <typename Visit>
void visit_tiles(const ScanSpan& scan, const geometry::Camera& camera, std::size_t tile_row,
                 Visit visit) {
  if (scan.pixels.empty()) {
    const std::size_t end = std::min(scan.points.size(), (tile_row + 1) * sweep_chunk);
    for (std::size_t i = tile_row * sweep_chunk; i < end; ++i) visit(i, i % tile_px);
    return;
  }
  const auto width = static_cast<std::uint32_t>(camera.width());
  const auto first_row = static_cast<std::uint32_t>(tile_row) * tile_px;
  const auto rows = std::min(tile_px, static_cast<std::uint32_t>(camera.height()) - first_row);
  std::array<std::size_t, tile_px> next;  // next return of each row
  for (std::uint32_t r = 0; r < rows; ++r) {
    next[r] = static_cast<std::size_t>(
        std::ranges::lower_bound(scan.pixels, (first_row + r) * width) - scan.pixels.begin());
  }
  for (std::uint32_t column = 0; column < width; column += tile_px) {
    for (std::uint32_t r = 0; r < rows; ++r) {
      const std::uint32_t first_pixel = (first_row + r) * width + column;
      const std::uint32_t end_pixel = first_pixel + std::min(tile_px, width - column);
      std::size_t& i = next[r];
      for (; i < scan.pixels.size() && scan.pixels[i] < end_pixel; ++i) {
        visit(i, scan.pixels[i] - first_pixel);
      }
    }
  }
}

}  // namespace

// Cells must be wider than pixels. Otherwise each return would occupy a separate cell and brick.
SpacedCloud::SpacedCloud(double spacing, double pixel)
    : points_(spacing, 2.0 * std::max(spacing, pixel)) {}

bool SpacedCloud::has_near(const Vector3f& position, double radius, std::size_t count) const {
  std::vector<geometry::Neighbour> found;
  points_.grid().find_within(position, radius, found);
  return std::ranges::any_of(
      found, [&](const geometry::Neighbour& neighbour) { return neighbour.index < count; });
}

std::size_t SpacedCloud::insert(const ScanSpan& scan, const geometry::Camera& camera,
                                const std::optional<Eigen::AlignedBox3f>& region,
                                std::uint32_t view, unsigned threads) {
  const std::size_t tile_rows =
      scan.pixels.empty() ? (scan.points.size() + sweep_chunk - 1) / sweep_chunk
                          : (static_cast<std::size_t>(camera.height()) + tile_px - 1) / tile_px;
  const std::size_t before = cloud_.size();
  points_.keep_all(
      scan.points, tile_px, tile_rows, threads,
      [&](std::size_t row, auto visit) {
        visit_tiles(scan, camera, row, [&](std::size_t i, std::size_t column) {
          if (region && !region->contains(scan.points[i])) return;
          visit(static_cast<std::uint32_t>(i), column);
        });
      },
      [&](std::uint32_t number) {
        cloud_.positions.push_back(scan.points[number]);
        cloud_.views.push_back(view);
      });
  return cloud_.size() - before;
}

}  // namespace skycap::survey::surfel
