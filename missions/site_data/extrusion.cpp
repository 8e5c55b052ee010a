#include "missions/site_data/extrusion.h"

#include <algorithm>
#include <utility>

#include "geometry/surfaces/polygon_triangulation.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;
using Corners = std::vector<Vector3d>;

/// Returns the signed area, positive for rings that are counter-clockwise from above.
double compute_area(std::span<const Vector3d> ring) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const Vector3d a = ring[i] - ring[0], b = ring[i + 1] - ring[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

void add_wall(Object& object, const Vector3d& from, const Vector3d& to, const Vector3d& to_top,
              const Vector3d& from_top) {
  if (from == to) return;
  geometry::Mesh& mesh = object.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {from, to, to_top, from_top});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

bool add_extruded(Object& object, std::span<const Vector3d> bottom, std::span<const Vector3d> top,
                  std::span<const std::uint32_t> begin) {
  Corners floor(bottom.begin(), bottom.end()), roof(top.begin(), top.end());
  for (std::size_t r = 0; r + 1 < begin.size(); ++r) {  // Holes have the opposite orientation.
    const auto from = static_cast<std::ptrdiff_t>(begin[r]),
               to = static_cast<std::ptrdiff_t>(begin[r + 1]);
    const bool is_ccw = compute_area(bottom.subspan(begin[r], begin[r + 1] - begin[r])) > 0.0;
    if (is_ccw == (r == 0)) continue;
    std::reverse(floor.begin() + from, floor.begin() + to);
    std::reverse(roof.begin() + from, roof.begin() + to);
  }
  geometry::Mesh& mesh = object.mesh;
  const auto name = [&](SurfaceKind kind) { object.surfaces.resize(mesh.triangles.size(), kind); };
  if (geometry::add_polygon(mesh, roof, begin) == 0) return false;
  name(SurfaceKind::roof);
  const std::size_t first = mesh.triangles.size();
  geometry::add_polygon(mesh, floor, begin);
  for (std::size_t i = first; i < mesh.triangles.size(); ++i) {
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  }
  name(SurfaceKind::ground);
  for (std::size_t r = 0; r + 1 < begin.size(); ++r) {
    for (std::size_t i = begin[r]; i < begin[r + 1]; ++i) {
      const std::size_t next = i + 1 < begin[r + 1] ? i + 1 : begin[r];
      add_wall(object, floor[i], floor[next], roof[next], roof[i]);
    }
  }
  name(SurfaceKind::wall);
  return true;
}

}  // namespace skycap::missions::site_data
