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
#include "geometry/place/pose.h"
#include "geometry/place/world.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t most_ear_corners = 1000;  // clipping ears takes cubic time at worst

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// The polygon seen along its area vector (Newell's normal), from where it is counter-clockwise.
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
    if (cross(flat[i], flat[(i + 1) % flat.size()], flat[(i + 2) % flat.size()]) <= 0.0)
      return false;
  }
  return true;
}

void cut_into_fan(Mesh& mesh, std::span<const std::uint32_t> polygon) {
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    mesh.triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
  }
}

// A corner is an ear if it points outward and no other corner lies in its triangle.
bool is_ear(const std::vector<Vector2d>& flat, const std::vector<std::size_t>& left,
            std::size_t at) {
  const std::size_t n = left.size();
  const Vector2d &a = flat[left[(at + n - 1) % n]], &b = flat[left[at]],
                 &c = flat[left[(at + 1) % n]];
  if (cross(a, b, c) <= 0.0) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d& p = flat[left[i]];
    if (p == a || p == b || p == c) continue;
    if (cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0) return false;
  }
  return true;
}

void clip_ears(Mesh& mesh, std::span<const std::uint32_t> polygon,
               const std::vector<Vector2d>& flat) {
  std::vector<std::size_t> left(polygon.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  while (left.size() > 3) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(flat, left, ear)) ++ear;
    // Only a polygon that crosses itself, or a flat remainder, has no ear: any cut is as good.
    if (ear == left.size()) ear = 0;
    const std::size_t n = left.size();
    mesh.triangles.push_back(
        {polygon[left[(ear + n - 1) % n]], polygon[left[ear]], polygon[left[(ear + 1) % n]]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  mesh.triangles.push_back({polygon[left[0]], polygon[left[1]], polygon[left[2]]});
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
    if (dropped == 0) {  // only a file with such a polygon is copied
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
      if (is_place(mesh.vertices[v], farthest_vertex)) continue;
      require_place(
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
    } else if (polygon.size() <= most_ear_corners) {
      clip_ears(mesh, polygon, flat);
    } else {
      fail(i, "is not convex and has " + std::to_string(polygon.size()) +
                  " corners; the maximum is 1000; triangulate it first");
    }
  }
  return mesh;
}

}  // namespace skycap::geometry
