#include "geometry/surfaces/polygon_triangulation.h"

#include <array>
#include <cmath>
#include <deque>
#include <limits>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "geometry/pose/pose.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();

using PlaneKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
/// Face information: region between rings, or -1 if not yet known.
struct Region {
  int index = -1;
};
/// Vertex information: index in the mesh.
struct MeshVertex {
  std::uint32_t index = no_vertex;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<MeshVertex, PlaneKernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<
    PlaneKernel, CGAL::Triangulation_face_base_with_info_2<Region, PlaneKernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    PlaneKernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
    CGAL::Exact_predicates_tag>;

/// Plane of a ring with two axes, in which the ring is counter-clockwise.
struct Plane {
  Vector3d origin, right, up;

  Vector2d flat(const Vector3d& position) const {
    return {(position - origin).dot(right), (position - origin).dot(up)};
  }
};

/// Returns twice the area vector of a ring.
Vector3d area_vector(std::span<const Vector3d> ring) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    sum += (ring[i] - ring[0]).cross(ring[i + 1] - ring[0]);
  }
  return sum;
}

/// Returns a ring without repeated consecutive corners; the first corner follows the last.
std::vector<Vector3d> without_repetition(std::span<const Vector3d> ring) {
  std::vector<Vector3d> result;
  for (const Vector3d& corner : ring) {
    if (result.empty() || corner != result.back()) result.push_back(corner);
  }
  while (result.size() > 1 && result.back() == result.front()) result.pop_back();
  return result;
}

/// Returns whether a ring turns left at every corner and winds once; a pentagram winds twice.
bool is_convex(std::span<const Vector2d> ring) {
  const std::size_t n = ring.size();
  std::size_t num_x_turns = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d edge = ring[(i + 1) % n] - ring[i], next = ring[(i + 2) % n] - ring[(i + 1) % n];
    if (edge.x() * next.y() - edge.y() * next.x() <= 0.0) return false;
    if ((edge.x() < 0.0) != (next.x() < 0.0)) ++num_x_turns;
  }
  return num_x_turns <= 2;
}

std::size_t add_fan(Mesh& mesh, const std::vector<Vector3d>& ring) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  const auto corners = static_cast<std::uint32_t>(ring.size());
  for (std::uint32_t i = 1; i + 1 < corners; ++i) {
    mesh.triangles.push_back({first, first + i, first + i + 1});
  }
  return corners - 2;
}

/// Returns whether an odd number of rings surrounds a position.
bool is_inside(const Vector2d& position, const std::vector<std::vector<Vector2d>>& rings) {
  bool is_odd = false;
  for (const std::vector<Vector2d>& ring : rings) {
    for (std::size_t i = 0, before = ring.size() - 1; i < ring.size(); before = i++) {
      const Vector2d &a = ring[before], &b = ring[i];
      if ((a.y() > position.y()) == (b.y() > position.y())) continue;
      const double x = a.x() + (position.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (position.x() < x) is_odd = !is_odd;
    }
  }
  return is_odd;
}

Vector2d to_eigen(const PlaneKernel::Point_2& point) { return {point.x(), point.y()}; }

Vector2d compute_centre(const Triangulation::Face_handle& face) {
  Vector2d sum = Vector2d::Zero();
  for (int i = 0; i < 3; ++i) sum += to_eigen(face->vertex(i)->point());
  return sum / 3.0;
}

double compute_area(const Triangulation::Face_handle& face) {
  const Vector2d a = to_eigen(face->vertex(0)->point()), b = to_eigen(face->vertex(1)->point()),
                 c = to_eigen(face->vertex(2)->point());
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Assigns the region to all faces connected to `start` without crossing a constraint. Returns
/// their largest face.
Triangulation::Face_handle mark_region(const Triangulation& triangulation,
                                       Triangulation::Face_handle start, int region) {
  Triangulation::Face_handle largest = start;
  std::deque<Triangulation::Face_handle> open{start};
  start->info().index = region;
  while (!open.empty()) {
    const Triangulation::Face_handle face = open.front();
    open.pop_front();
    if (compute_area(face) > compute_area(largest)) largest = face;
    for (int i = 0; i < 3; ++i) {
      const Triangulation::Face_handle next = face->neighbor(i);
      if (triangulation.is_infinite(next) || next->info().index >= 0 || face->is_constrained(i)) {
        continue;
      }
      next->info().index = region;
      open.push_back(next);
    }
  }
  return largest;
}

/// Inserts the rings as constraints and adds a mesh vertex for each corner.
void insert_rings(Triangulation& triangulation, Mesh& mesh, const Plane& plane,
                  const std::vector<std::vector<Vector3d>>& rings) {
  for (const std::vector<Vector3d>& ring : rings) {
    std::vector<Triangulation::Vertex_handle> corners;
    for (const Vector3d& corner : ring) {
      const Vector2d flat = plane.flat(corner);
      const auto vertex = triangulation.insert({flat.x(), flat.y()});
      if (vertex->info().index == no_vertex) {
        vertex->info().index = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(corner);
      }
      corners.push_back(vertex);
    }
    for (std::size_t i = 0, before = corners.size() - 1; i < corners.size(); before = i++) {
      if (corners[before] != corners[i])
        triangulation.insert_constraint(corners[before], corners[i]);
    }
  }
}

/// Returns the mesh vertex; at crossings of rings, adds a new one on the plane.
std::uint32_t find_vertex(Mesh& mesh, const Plane& plane, Triangulation::Vertex_handle vertex) {
  std::uint32_t& index = vertex->info().index;
  if (index == no_vertex) {
    index = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vector2d flat = to_eigen(vertex->point());
    mesh.vertices.push_back(plane.origin + flat.x() * plane.right + flat.y() * plane.up);
  }
  return index;
}

std::size_t add_triangulated(Mesh& mesh, const Plane& plane,
                             const std::vector<std::vector<Vector3d>>& rings,
                             const std::vector<std::vector<Vector2d>>& flat) {
  Triangulation triangulation;
  insert_rings(triangulation, mesh, plane, rings);
  std::vector<bool> is_region_inside;
  std::size_t count = 0;
  for (const Triangulation::Face_handle face : triangulation.finite_face_handles()) {
    if (face->info().index < 0) {
      const auto largest =
          mark_region(triangulation, face, static_cast<int>(is_region_inside.size()));
      is_region_inside.push_back(is_inside(compute_centre(largest), flat));
    }
    if (!is_region_inside[static_cast<std::size_t>(face->info().index)]) continue;
    std::array<std::uint32_t, 3> triangle;
    for (int i = 0; i < 3; ++i) {
      triangle[static_cast<std::size_t>(i)] = find_vertex(mesh, plane, face->vertex(i));
    }
    mesh.triangles.push_back(triangle);
    ++count;
  }
  return count;
}

}  // namespace

std::size_t add_polygon(Mesh& mesh, std::span<const Vector3d> corners,
                        std::span<const std::uint32_t> begin) {
  std::vector<std::vector<Vector3d>> rings;
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
    rings.push_back(without_repetition(corners.subspan(begin[i], begin[i + 1] - begin[i])));
    if (rings.back().size() >= 3) continue;
    rings.pop_back();
    if (i == 0) return 0;  // the other rings are its holes
  }
  if (rings.empty()) return 0;
  const Vector3d area = area_vector(rings[0]);
  if (!(area.norm() > 0.0) || !std::isfinite(area.norm())) return 0;
  const Vector3d normal = area.normalized(), right = any_orthogonal(normal);
  const Plane plane{rings[0][0], right, normal.cross(right)};
  std::vector<std::vector<Vector2d>> flat;
  for (const std::vector<Vector3d>& ring : rings) {
    std::vector<Vector2d>& flat_ring = flat.emplace_back();
    for (const Vector3d& corner : ring) {
      flat_ring.push_back(plane.flat(corner));
      if (!flat_ring.back().allFinite()) return 0;
    }
  }
  if (rings.size() == 1 && (rings[0].size() == 3 || is_convex(flat[0]))) {
    return add_fan(mesh, rings[0]);
  }
  return add_triangulated(mesh, plane, rings, flat);
}

}  // namespace skycap::geometry
