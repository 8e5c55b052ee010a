#include "missions/package/replan/measured_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Half of the side of a square in units of the point spacing. The squares of neighbours overlap,
/// since no position on the surface is farther than the spacing from a stored point.
constexpr double half_side = 0.71;

/// Distance from a target within which its own surface does not occlude it, in units of the point
/// spacing. Squares of neighbours differ by the noise of the sensor.
constexpr double near_target = 2.5;

constexpr std::size_t max_samples = 100'000;

geometry::Mesh squares(std::span<const Vector3f> points, std::span<const Vector3f> normals,
                       double spacing) {
  geometry::Mesh mesh;
  mesh.vertices.reserve(4 * points.size());
  mesh.triangles.reserve(2 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d normal = normals[i].cast<double>();
    const Vector3d u = half_side * spacing * normal.unitOrthogonal(), v = normal.cross(u);
    const Vector3d centre = points[i].cast<double>();
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(),
                         {centre - u - v, centre + u - v, centre + u + v, centre - u + v});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

std::vector<Vector3f> every_nth(std::span<const Vector3f> points) {
  const std::size_t stride = points.size() / max_samples + 1;
  std::vector<Vector3f> samples;
  for (std::size_t i = 0; i < points.size(); i += stride) samples.push_back(points[i]);
  return samples;
}

}  // namespace

MeasuredSurface::MeasuredSurface(double spacing, const geometry::PointCloud& cloud,
                                 std::span<const Vector3f> normals, unsigned threads)
    : spacing_(spacing),
      samples_(every_nth(cloud.positions)),
      normals_(every_nth(normals)),
      scene_(squares(cloud.positions, normals, spacing), threads) {}

std::vector<survey::surfel::GainField::Target> MeasuredSurface::targets(
    std::size_t max_count) const {
  std::vector<survey::surfel::GainField::Target> targets;
  const std::size_t stride = (samples_.size() + max_count - 1) / max_count;
  for (std::size_t i = 0; i < samples_.size(); i += stride) {
    targets.push_back({samples_[i], normals_[i], 1.0F});
  }
  return targets;
}

std::vector<std::uint8_t> MeasuredSurface::in_sight(const Vector3d& position,
                                                    std::span<const Vector3f> targets) const {
  const double ignored = near_target * spacing_;
  std::vector<std::uint8_t> marks;
  marks.reserve(targets.size());
  std::array<sim::Scene::SightLine, sim::Scene::max_sight_lines> lines;
  for (std::size_t first = 0; first < targets.size(); first += lines.size()) {
    const std::size_t count = std::min(lines.size(), targets.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3d ray = targets[first + i].cast<double>() - position;
      const double length = ray.norm();
      lines[i] = {position, position + std::max(0.0, 1.0 - ignored / length) * ray};
    }
    const std::uint32_t blocked = scene_.blocked({lines.data(), count});
    for (std::size_t i = 0; i < count; ++i) marks.push_back((blocked >> i & 1U) == 0U ? 1 : 0);
  }
  return marks;
}

}  // namespace skycap::missions::package
