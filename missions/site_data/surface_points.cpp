#include "missions/site_data/surface_points.h"

#include <algorithm>
#include <cmath>

#include "flight/clearance/triangle_tree.h"
#include "flight/clearance/winding.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Maximum height above the lowest vertex of horizontal surfaces that belong to the foot [m].
constexpr double foot_height = 0.5;
constexpr double level = 0.9;  // Minimum absolute z of the normal of a horizontal surface.

/// Distance from the surface at which positions are tested for being inside the object [m].
constexpr float probe_distance = 0.05F;

Vector3d area_vector(const geometry::Mesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
  return 0.5 * (q - p).cross(r - p);
}

SurfaceKind surface_kind(const Object& object, std::size_t triangle) {
  return triangle < object.surfaces.size() ? object.surfaces[triangle] : SurfaceKind::unknown;
}

/// Visible triangles of the object and their indices in the object.
struct VisiblePart {
  geometry::Mesh mesh;
  std::vector<std::size_t> triangles;
};

VisiblePart visible_part(const Object& object) {
  VisiblePart part;
  part.mesh.vertices = object.mesh.vertices;
  const double foot = geometry::bounding_box(object.mesh).min().z() + foot_height;
  for (std::size_t t = 0; t < object.mesh.triangles.size(); ++t) {
    const auto& corners = object.mesh.triangles[t];
    const Vector3d normal = area_vector(object.mesh, t);
    const bool is_low = std::ranges::all_of(
        corners, [&](auto vertex) { return object.mesh.vertices[vertex].z() < foot; });
    const bool is_foot = is_low && std::abs(normal.z()) >= level * normal.norm();
    if (is_foot || normal.norm() == 0.0 || surface_kind(object, t) == SurfaceKind::ground) continue;
    part.mesh.triangles.push_back(corners);
    part.triangles.push_back(t);
  }
  return part;
}

}  // namespace

SurfacePoints spread_over(const Object& object, std::size_t max, double spacing) {
  SurfacePoints points;
  if (object.mesh.triangles.empty()) return points;
  const VisiblePart part = visible_part(object);
  if (part.mesh.triangles.empty()) return points;
  const double area = geometry::surface_area(part.mesh);
  const double target_count = std::ceil(area / (spacing * spacing));
  const auto count =
      static_cast<std::size_t>(std::clamp(target_count, 1.0, static_cast<double>(max)));
  constexpr std::uint64_t seed = 1;
  const geometry::SurfaceSamples samples = geometry::sample_surface(part.mesh, count, seed);
  points.area_per_point = area / static_cast<double>(count);
  flight::TriangleTree solid;
  solid.triangles = flight::to_triangles(object.mesh);
  solid.index();
  const flight::WindingNumber winding(solid.tree, solid.triangles);
  const auto is_inside = [&](const Vector3f& point) {
    return winding.at(solid.tree, solid.triangles, point.cast<double>()) > 0.5;
  };
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Vector3f &position = samples.points[i], &normal = samples.normals[i];
    const bool is_turned = is_inside(position + probe_distance * normal);
    if (is_turned && is_inside(position - probe_distance * normal))
      continue;  // Solid on both sides.
    points.positions.push_back(position);
    points.normals.push_back(is_turned ? Vector3f(-normal) : normal);
    points.kinds.push_back(surface_kind(object, part.triangles[samples.triangles[i]]));
  }
  return points;
}

}  // namespace skycap::missions::site_data
