/// Areas on the map and vertical volumes above them, for geofences and no-fly volumes. World frame,
/// z up. The border belongs to the area in all queries.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Vertical prism over a polygon.
struct Prism {
  std::string name;  ///< used in messages
  std::vector<Eigen::Vector2d>
      footprint;  ///< simple polygon in either orientation, without repeated first corner
  double floor = -std::numeric_limits<double>::infinity();
  double ceiling = std::numeric_limits<double>::infinity();
};

/// Returns twice the signed area of the triangle: positive if the path a, b, c turns left.
inline double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d along = b - a, across = c - a;
  return along.x() * across.y() - along.y() * across.x();
}

/// Returns whether a point is inside a simple polygon or on its border. The border is decided by
/// the exact floating-point result of turn().
bool contains(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point);

/// Returns whether a point is inside the prism or on its boundary.
bool contains(const Prism& prism, const Eigen::Vector3d& point);

}  // namespace skycap::geometry
