#include <algorithm>
#include <cmath>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include "geometry/spherical_cap_methods.h"

// The largest empty cap by cutting planes. The hull of a small part W of Q tells, in its facet
// nearest to the origin, the largest cap that is empty of W: a bound on the answer. A member of Q
// inside that cap joins W; when there is none, the cap is empty of Q.
namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Hull = CGAL::Surface_mesh<Kernel::Point_3>;

struct Facet {
  Vector3d normal;  // outward, of unit length
  double distance;  // of its plane from the origin
};

Vector3d to_eigen(const Kernel::Point_3& point) { return {point.x(), point.y(), point.z()}; }

/// The hull's facets, the nearest to the origin first.
std::vector<Facet> hull_facets(const std::vector<Vector3d>& members) {
  std::vector<Kernel::Point_3> points;
  points.reserve(members.size());
  for (const Vector3d& q : members) points.emplace_back(q.x(), q.y(), q.z());
  Hull hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);

  std::vector<Facet> facets;
  for (const Hull::Face_index face : hull.faces()) {
    Triangle corners;
    std::size_t corner = 0;
    for (const Hull::Vertex_index v : hull.vertices_around_face(hull.halfedge(face))) {
      corners[corner++] = to_eigen(hull.point(v));
    }
    const Vector3d normal = normal_of(corners);
    if (normal.squaredNorm() == 0.0) continue;  // thinner than double precision can tell
    const Vector3d unit = normal.normalized();
    facets.push_back({unit, unit.dot(corners[0])});
  }
  std::sort(facets.begin(), facets.end(),
            [](const Facet& a, const Facet& b) { return a.distance < b.distance; });
  return facets;
}

// Among equal caps: nearest to `known_clear`; if these are equal too, the smaller coordinates.
bool is_preferred(const Vector3d& a, const Vector3d& b, const Vector3d& known_clear) {
  const double difference = a.dot(known_clear) - b.dot(known_clear);
  if (std::abs(difference) > cap_tolerance) return difference > 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(a[axis] - b[axis]) > cap_tolerance) return a[axis] < b[axis];
  }
  return false;
}

bool contains(const std::vector<Vector3d>& members, const Vector3d& q) {
  return std::find(members.begin(), members.end(), q) != members.end();
}

std::vector<Vector3d> first_members(DirectionIndex& occluded, std::span<const Vector3d> seeds) {
  std::vector<Vector3d> members(seeds.begin(), seeds.end());
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) {
          members.push_back(occluded.nearest(Vector3d(x, y, z).normalized()).direction);
        }
      }
    }
  }
  return members;
}

}  // namespace

SphericalCap largest_empty_cap(DirectionIndex& occluded, std::span<const Vector3d> seeds,
                               const Vector3d& known_clear) {
  std::vector<Vector3d> members = first_members(occluded, seeds);
  double best_cosine = 1.0;  // of the caps that were looked at; bounds the answer from above
  while (true) {
    std::vector<SphericalCap> caps;
    const std::size_t members_before = members.size();
    for (const Facet& facet : hull_facets(members)) {
      if (facet.distance > best_cosine + cap_tolerance) break;
      const auto nearest = occluded.nearest(facet.normal);
      // A facet too thin for an exact normal may seem to have one of its own corners outside.
      if (nearest.cosine > facet.distance + 1e-9 && !contains(members, nearest.direction)) {
        members.push_back(nearest.direction);
      }
      caps.push_back({facet.normal, nearest.cosine});
      best_cosine = std::min(best_cosine, nearest.cosine);
    }
    if (members.size() > members_before) continue;

    SphericalCap best = caps.front();
    for (const SphericalCap& cap : caps) {
      if (cap.cosine <= best_cosine + cap_tolerance &&
          is_preferred(cap.direction, best.direction, known_clear)) {
        best = cap;
      }
    }
    return best;
  }
}

}  // namespace skycap::geometry
