/// Areas on the map and the upright volumes over them: geofences and no-fly volumes. World frame, z
/// up. One rule at the border for all who ask: it belongs to the area.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// An upright prism over a polygon.
struct Prism {
  std::string name;                        ///< for messages
  std::vector<Eigen::Vector2d> footprint;  ///< simple polygon, either way round, not closed
  double floor = -std::numeric_limits<double>::infinity();
  double ceiling = std::numeric_limits<double>::infinity();
};

/// Twice the signed area of the triangle: positive if it turns left from a over b to c.
inline double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d along = b - a, across = c - a;
  return along.x() * across.y() - along.y() * across.x();
}

/// Whether a point is in a simple polygon or, to the last bit of turn(), on its border.
bool contains(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point);

/// Whether a point is in the prism or on its boundary.
bool contains(const Prism& prism, const Eigen::Vector3d& point);

}  // namespace skycap::geometry
