#include "missions/online/live/range_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;

constexpr int side = 96;  // Cells along an edge of the cube.
constexpr std::size_t cell_count = std::size_t{6} * side * side;
constexpr std::size_t max_points = 400'000;
constexpr float infinity = std::numeric_limits<float>::infinity();

/// Returns the cell of a non-zero direction.
std::size_t cell_index(const Vector3d& direction) {
  Eigen::Index axis = 0;
  const double length = direction.cwiseAbs().maxCoeff(&axis);
  const int face = 2 * static_cast<int>(axis) + (direction[axis] < 0.0 ? 1 : 0);
  const auto direction_from = [&](Eigen::Index along) {
    const double from_edge = 0.5 * (direction[along] / length + 1.0) * side;
    return std::clamp(static_cast<int>(from_edge), 0, side - 1);
  };
  const int row = direction_from((axis + 1) % 3), column = direction_from((axis + 2) % 3);
  return static_cast<std::size_t>((face * side + row) * side + column);
}

}  // namespace

RangeImage::RangeImage(const geometry::ScanSpan& scan)
    : sensor_(scan.sensor_position()), cells_(cell_count, {infinity, -infinity}) {
  std::vector<Cell> own(cell_count, {infinity, -infinity});
  const std::size_t stride = std::max<std::size_t>(1, scan.points.size() / max_points);
  for (std::size_t i = 0; i < scan.points.size(); i += stride) {
    const Vector3d ray = scan.points[i].cast<double>() - sensor_;
    const auto range = static_cast<float>(ray.norm());
    if (range == 0.0F) continue;
    Cell& cell = own[cell_index(ray)];
    cell = {std::min(cell.nearest, range), std::max(cell.farthest, range)};
  }
  for (std::size_t face = 0; face < 6; ++face) {
    for (std::size_t row = 1; row + 1 < side; ++row) {
      for (std::size_t column = 1; column + 1 < side; ++column) {
        const std::size_t middle = (face * side + row) * side + column;
        Cell all{infinity, -infinity};
        bool is_whole = true;
        for (std::size_t above = middle - side; above <= middle + side; above += side) {
          for (std::size_t near = above - 1; near <= above + 1; ++near) {
            is_whole = is_whole && own[near].nearest <= own[near].farthest;
            all = {std::min(all.nearest, own[near].nearest),
                   std::max(all.farthest, own[near].farthest)};
          }
        }
        if (is_whole) cells_[middle] = all;
      }
    }
  }
}

Visibility RangeImage::visibility(const Vector3d& point, double tolerance) const {
  const Vector3d ray = point - sensor_;
  const double range = ray.norm();
  if (range == 0.0) return Visibility::unknown;
  const Cell& cell = cells_[cell_index(ray)];
  if (cell.nearest > cell.farthest) return Visibility::unknown;
  if (range < cell.nearest - tolerance) return Visibility::through;
  return range <= cell.farthest + tolerance ? Visibility::there : Visibility::hidden;
}

}  // namespace skycap::missions::online
