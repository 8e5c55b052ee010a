#include "geometry/pose/prism.h"

namespace skycap::geometry {

using Eigen::Vector2d;

bool contains(std::span<const Vector2d> polygon, const Vector2d& point) {
  bool inside = false;  // parity of the intersections with a ray towards +x
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double side = turn(a, b, point);
    if (side == 0.0 && (point - a).dot(point - b) <= 0.0) return true;  // on this edge
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const bool is_left_of_edge = (side > 0.0) == (b.y() > a.y());
    if (is_left_of_edge) inside = !inside;
  }
  return inside;
}

bool contains(const Prism& prism, const Eigen::Vector3d& point) {
  return point.z() >= prism.floor && point.z() <= prism.ceiling &&
         contains(prism.footprint, point.head<2>());
}

}  // namespace skycap::geometry
