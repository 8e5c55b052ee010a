#include "sim/models/masonry/wall_tiles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;

/// Positions the points between two corners in proportion.
void share_out(const Polyline2& polygon, const std::vector<std::size_t>& bends, Polyline2& moved) {
  const std::size_t size = polygon.size();
  for (std::size_t k = 0; k < bends.size(); ++k) {
    const std::size_t first = bends[k], last = bends[(k + 1) % bends.size()];
    const double length = (polygon[last] - polygon[first]).norm();
    for (std::size_t i = (first + 1) % size; i != last; i = (i + 1) % size) {
      const double share = (polygon[i] - polygon[first]).norm() / length;
      moved[i] = moved[first] + share * (moved[last] - moved[first]);
    }
  }
}

}  // namespace

SideSplitter::SideSplitter(const Wall& wall) {
  const auto add = [&](const Polyline2& polygon) {
    for (const Vector2d& corner : polygon) {
      for (const double turn : {-1.0, 0.0, 1.0}) {
        const Vector2d shifted(corner.x() + turn * wall.plan.length(), corner.y());
        auto& cell = cells_[cell_at(shifted)];
        const auto is_same = [&](const Vector2d& p) { return (p - shifted).norm() < same_corner; };
        if (std::none_of(cell.begin(), cell.end(), is_same)) cell.push_back(shifted);
      }
    }
  };
  for (const Polyline2& tile : wall.tiles) add(tile);
  for (const Opening& opening : wall.openings) add(opening.outline());
}

Polyline2 SideSplitter::split(const Polyline2& tile) const {
  Polyline2 refined;
  for (std::size_t i = 0; i < tile.size(); ++i) {
    const Vector2d &a = tile[i], &b = tile[(i + 1) % tile.size()];
    refined.push_back(a);
    for (const Vector2d& corner : corners_within(a, b)) refined.push_back(corner);
  }
  return refined;
}

SideSplitter::Cell SideSplitter::cell_at(const Vector2d& along_wall) {
  return {static_cast<std::int64_t>(std::floor(along_wall.x() / 0.5)),
          static_cast<std::int64_t>(std::floor(along_wall.y() / 0.5))};
}

Polyline2 SideSplitter::corners_within(const Vector2d& a, const Vector2d& b) const {
  const Vector2d margin(same_corner, same_corner), along = b - a;
  const Cell first = cell_at(a.cwiseMin(b) - margin), last = cell_at(a.cwiseMax(b) + margin);
  Polyline2 corners;
  for (std::int64_t x = first[0]; x <= last[0]; ++x) {
    for (std::int64_t y = first[1]; y <= last[1]; ++y) {
      const auto cell = cells_.find({x, y});
      if (cell == cells_.end()) continue;
      for (const Vector2d& corner : cell->second) {
        const bool is_off_line = std::abs(cross(along, corner - a)) > same_corner * along.norm();
        const double along_wall = (corner - a).dot(along) / along.norm();
        if (!is_off_line && along_wall > 2 * same_corner &&
            along_wall < along.norm() - 2 * same_corner) {
          corners.push_back(corner);
        }
      }
    }
  }
  const auto is_nearer = [&](const Vector2d& p, const Vector2d& q) {
    return (p - a).squaredNorm() < (q - a).squaredNorm();
  };
  std::sort(corners.begin(), corners.end(), is_nearer);
  // One corner may have been found in two cells.
  const auto is_same = [](const Vector2d& p, const Vector2d& q) {
    return (p - q).norm() < 3 * same_corner;
  };
  corners.erase(std::unique(corners.begin(), corners.end(), is_same), corners.end());
  return corners;
}

Polyline2 inset(const Polyline2& polygon, const std::vector<double>& distances) {
  const std::size_t size = polygon.size();
  assert(size >= 3);
  Polyline2 result(size);
  std::vector<double> bend(size);
  std::vector<std::size_t> bends;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t before = (i + size - 1) % size;
    const Vector2d in = (polygon[i] - polygon[before]).normalized();
    const Vector2d out = (polygon[(i + 1) % size] - polygon[i]).normalized();
    bend[i] = cross(in, out);
    if (std::abs(bend[i]) < 1e-6) continue;
    // Intersection of the two displaced sides: the point at those distances to the left of both.
    result[i] = polygon[i] + (distances[before] * out - distances[i] * in) / bend[i];
    bends.push_back(i);
  }
  share_out(polygon, bends, result);
  for (std::size_t k = 0; k < bends.size() && bends.size() > 3;) {
    const std::size_t first = bends[k], last = bends[(k + 1) % bends.size()];
    if ((result[last] - result[first]).dot(polygon[last] - polygon[first]) > 0.0) {
      ++k;
      continue;
    }
    const std::size_t blunter = std::abs(bend[first]) < std::abs(bend[last]) ? first : last;
    bends.erase(std::find(bends.begin(), bends.end(), blunter));
    share_out(polygon, bends, result);
    k = 0;
  }
  return result;
}

}  // namespace skycap::sim::models
