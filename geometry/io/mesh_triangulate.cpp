#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/error.h"
#include "geometry/io/mesh_formats.h"
#include "geometry/pose/pose.h"
#include "geometry/pose/prism.h"
#include "geometry/pose/world.h"
#include "geometry/surfaces/ear_clipping.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t max_ear_corners = 1000;  // ear clipping takes cubic time in the worst case

// Projects the polygon along its area vector (Newell's normal), so that it is counter-clockwise.
std::vector<Vector2d> flattened(const Mesh& mesh, std::span<const std::uint32_t> polygon) {
  const Vector3d& origin = mesh.vertices[polygon[0]];
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    normal += (mesh.vertices[polygon[i]] - origin)
                  .cross(mesh.vertices[polygon[(i + 1) % polygon.size()]] - origin);
  }
  normal = normal.norm() > 0.0 ? Vector3d(normal.normalized()) : Vector3d(Vector3d::UnitZ());
  const Vector3d right = any_orthogonal(normal), up = normal.cross(right);
  std::vector<Vector2d> flat;
  flat.reserve(polygon.size());
  for (const std::uint32_t v : polygon) {
    const Vector3d offset = mesh.vertices[v] - origin;
    flat.emplace_back(offset.dot(right), offset.dot(up));
  }
  return flat;
}

bool is_convex(const std::vector<Vector2d>& flat) {
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (turn(flat[i], flat[(i + 1) % flat.size()], flat[(i + 2) % flat.size()]) <= 0.0)
      return false;
  }
  return true;
}

void cut_into_fan(Mesh& mesh, std::span<const std::uint32_t> polygon) {
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    mesh.triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
  }
}

}  // namespace

std::size_t drop_infinite_polygons(PolygonSoup& soup) {
  PolygonSoup kept;
  const std::size_t count = soup.polygon_begin.size() - 1;
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto first = soup.corners.begin() + static_cast<std::ptrdiff_t>(soup.polygon_begin[i]);
    const auto last = soup.corners.begin() + static_cast<std::ptrdiff_t>(soup.polygon_begin[i + 1]);
    const bool is_finite =
        std::all_of(first, last, [&](std::uint32_t v) { return soup.vertices[v].allFinite(); });
    if (is_finite && dropped == 0) continue;
    if (dropped == 0) {  // copies only if such a polygon exists
      kept.corners.assign(soup.corners.begin(), first);
      kept.polygon_begin.assign(soup.polygon_begin.begin(),
                                soup.polygon_begin.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      kept.polygon_materials.assign(
          soup.polygon_materials.begin(),
          soup.polygon_materials.begin() +
              static_cast<std::ptrdiff_t>(std::min(i, soup.polygon_materials.size())));
    }
    if (!is_finite) {
      ++dropped;
      continue;
    }
    kept.corners.insert(kept.corners.end(), first, last);
    kept.polygon_begin.push_back(kept.corners.size());
    if (!soup.polygon_materials.empty()) {
      kept.polygon_materials.push_back(soup.polygon_materials[i]);
    }
  }
  if (dropped == 0) return 0;
  soup.corners = std::move(kept.corners);
  soup.polygon_begin = std::move(kept.polygon_begin);
  soup.polygon_materials = std::move(kept.polygon_materials);
  return dropped;
}

Mesh triangulate(std::string_view name, PolygonSoup soup) {
  const auto fail = [name](std::size_t polygon, const std::string& what) {
    throw Error(ErrorKind::bad_file,
                std::string(name) + ": face " + std::to_string(polygon) + " " + what);
  };
  Mesh mesh{std::move(soup.vertices), {}};
  mesh.triangles.reserve(soup.polygon_begin.size());
  for (std::size_t i = 0; i + 1 < soup.polygon_begin.size(); ++i) {
    const std::span polygon(soup.corners.data() + soup.polygon_begin[i],
                            soup.polygon_begin[i + 1] - soup.polygon_begin[i]);
    for (const std::uint32_t v : polygon) {
      if (is_valid_position(mesh.vertices[v], farthest_vertex)) continue;
      require_valid_position(
          mesh.vertices[v],
          std::string(name) + ": face " + std::to_string(i) + ": vertex " + std::to_string(v),
          farthest_vertex);
    }
    if (polygon.size() < 3) continue;
    if (polygon.size() == 3) {
      mesh.triangles.push_back({polygon[0], polygon[1], polygon[2]});
      continue;
    }
    const std::vector<Vector2d> flat = flattened(mesh, polygon);
    if (is_convex(flat)) {
      cut_into_fan(mesh, polygon);
    } else if (polygon.size() <= max_ear_corners) {
      for (const auto& [a, b, c] : clip_ears(flat)) {
        mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
      }
    } else {
      fail(i, "is not convex and has " + std::to_string(polygon.size()) +
                  " corners; the maximum is 1000; triangulate it first");
    }
  }
  return mesh;
}

}  // namespace skycap::geometry
