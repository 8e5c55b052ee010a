#include "flight/clearance/winding.h"

#include <cmath>
#include <numbers>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Distance in node radii beyond which a node is approximated by a dipole. Barill et al. recommend
/// at least 2.
constexpr double far_radii = 2.5;

/// Maximum sum of area vectors, relative to the area, of a closed surface. Exactly closed surfaces
/// have a zero sum.
constexpr double closed_remainder = 0.05;

/// Returns the solid angle of a triangle divided by 4 pi (Van Oosterom & Strackee 1983).
double compute_sphere_fraction(const Triangle& triangle, const Vector3d& point) {
  const Vector3d a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return std::atan2(numerator, denominator) / (2.0 * std::numbers::pi);
}

}  // namespace

WindingNumber::WindingNumber(const BoundingTree& tree, const std::vector<Triangle>& triangles)
    : dipoles_(tree.nodes().size()) {
  if (tree.empty()) return;
  const Dipole whole = gather(tree, triangles, 0);
  if (whole.area_vector.norm() > closed_remainder * whole.area) return;
  double volume = 0.0;  // Six times the volume.
  for (const auto& [a, b, c] : triangles) {
    volume += (a - whole.centre).dot((b - whole.centre).cross(c - whole.centre));
  }
  orientation_ = volume < 0.0 ? -1.0 : 1.0;
}

double WindingNumber::at(const BoundingTree& tree, const std::vector<Triangle>& triangles,
                         const Vector3d& point) const {
  return tree.empty() ? 0.0 : orientation_ * sum(tree, triangles, point, 0);
}

WindingNumber::Dipole WindingNumber::gather(const BoundingTree& tree,
                                            const std::vector<Triangle>& triangles,
                                            std::uint32_t node_index) {
  const BoundingTree::Node& node = tree.nodes()[node_index];
  Dipole dipole;
  Vector3d weighted_centre = Vector3d::Zero();
  const auto add = [&](const Vector3d& area_vector, const Vector3d& centre, double area) {
    dipole.area_vector += area_vector;
    weighted_centre += area * centre;
    dipole.area += area;
  };
  if (node.count > 0) {
    for (std::uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
      const auto& [a, b, c] = triangles[tree.items()[slot]];
      const Vector3d area_vector = 0.5 * (b - a).cross(c - a);
      add(area_vector, (a + b + c) / 3.0, area_vector.norm());
    }
  } else {
    for (const std::uint32_t child : {node_index + 1, node.first}) {
      const Dipole part = gather(tree, triangles, child);
      add(part.area_vector, part.centre, part.area);
    }
  }
  dipole.centre = dipole.area > 0.0 ? Vector3d(weighted_centre / dipole.area) : node.box.center();
  const Vector3d farthest_corner =
      (dipole.centre - node.box.min()).cwiseMax(node.box.max() - dipole.centre);
  dipole.squared_reach = farthest_corner.squaredNorm();
  dipoles_[node_index] = dipole;
  return dipole;
}

double WindingNumber::sum(const BoundingTree& tree, const std::vector<Triangle>& triangles,
                          const Vector3d& point, std::uint32_t node_index) const {
  const Dipole& dipole = dipoles_[node_index];
  const Vector3d towards = dipole.centre - point;
  const double squared_distance = towards.squaredNorm();
  if (squared_distance > far_radii * far_radii * dipole.squared_reach) {
    return dipole.area_vector.dot(towards) /
           (4.0 * std::numbers::pi * squared_distance * std::sqrt(squared_distance));
  }
  const BoundingTree::Node& node = tree.nodes()[node_index];
  if (node.count == 0) {
    return sum(tree, triangles, point, node_index + 1) + sum(tree, triangles, point, node.first);
  }
  double total = 0.0;
  for (std::uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
    total += compute_sphere_fraction(triangles[tree.items()[slot]], point);
  }
  return total;
}

}  // namespace skycap::flight
