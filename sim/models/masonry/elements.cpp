#include "sim/models/masonry/elements.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace skycap::sim::models {

using Eigen::Vector3d;
using geometry::Mesh;

Mesh bar(const Vector3d& from, const Vector3d& to, double radius, const Fineness& fineness) {
  const Vector3d axis = (to - from).normalized();
  const Vector3d aside = axis.unitOrthogonal(), up = axis.cross(aside);
  const int chords = std::max(6, fineness.circle(radius));
  std::vector<Polyline3> rings(2);
  for (int i = 0; i < chords; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / chords;
    const Vector3d out = radius * (std::cos(angle) * aside + std::sin(angle) * up);
    rings[0].push_back(from + out);
    rings[1].push_back(to + out);
  }
  return loft(rings);
}

Mesh block(double x, double y, double width, double depth, double low, double high) {
  return box({x - 0.5 * width, y - 0.5 * depth, low}, {x + 0.5 * width, y + 0.5 * depth, high});
}

Mesh gabled_roof(double width, double depth, double foot, double slope, double eaves,
                 double verge) {
  const double half = 0.5 * depth + eaves;
  return extrude({{-half, foot - 0.25},
                  {half, foot - 0.25},
                  {half, foot},
                  {0.0, foot + slope * half},
                  {-half, foot}},
                 -0.5 * width - verge, 0.5 * width + verge);
}

Polyline3 level_rectangle(double width, double depth, double z) {
  const double x = 0.5 * width, y = 0.5 * depth;
  return {{-x, -y, z}, {x, -y, z}, {x, y, z}, {-x, y, z}};
}

Mesh frustum(double foot_radius, double top_radius, double low, double high,
             const Fineness& fineness) {
  return revolve({{0.0, low}, {foot_radius, low}, {top_radius, high}, {0.0, high}},
                 std::max(8, fineness.circle(foot_radius)));
}

}  // namespace skycap::sim::models
