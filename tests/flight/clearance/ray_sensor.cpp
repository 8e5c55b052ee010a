#include "tests/flight/clearance/ray_sensor.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns the distance to the first triangle along a ray (Moeller & Trumbore 1997).
std::optional<double> first_hit(const geometry::Mesh& mesh, const Vector3d& origin,
                                const Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vector3d& a = mesh.vertices[ia];
    const Vector3d ab = mesh.vertices[ib] - a, ac = mesh.vertices[ic] - a;
    const Vector3d p = direction.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant == 0.0) continue;
    const Vector3d s = origin - a, q = s.cross(ab);
    const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
    const double t = ac.dot(q) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || t <= 0.0) continue;
    nearest = std::min(nearest, t);
  }
  return std::isfinite(nearest) ? std::optional(nearest) : std::nullopt;
}

}  // namespace

geometry::Scan depth_image(const geometry::Mesh& scene, const geometry::Camera& camera,
                           const geometry::View& view) {
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose(view);
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const Vector3d ray = scan.world_from_sensor.linear() * camera.ray({column, row});
      const auto depth = first_hit(scene, view.position, ray);
      if (!depth) continue;
      scan.points.push_back((view.position + *depth * ray).cast<float>());
      scan.pixels.push_back(static_cast<std::uint32_t>(row * camera.width() + column));
    }
  }
  return scan;
}

geometry::Scan scan_around(const geometry::Mesh& scene, const Vector3d& position, double spacing) {
  geometry::Scan scan;
  scan.world_from_sensor.translation() = position;
  for (double elevation = -std::numbers::pi / 2; elevation <= std::numbers::pi / 2;
       elevation += spacing) {
    for (double azimuth = -std::numbers::pi; azimuth < std::numbers::pi; azimuth += spacing) {
      const Vector3d ray(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                         std::cos(azimuth) * std::cos(elevation));
      if (const auto range = first_hit(scene, position, ray)) {
        scan.points.push_back((position + *range * ray).cast<float>());
      }
    }
  }
  return scan;
}

}  // namespace skycap::flight
