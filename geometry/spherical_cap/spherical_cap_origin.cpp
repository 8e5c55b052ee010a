#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/spherical_cap/spherical_cap_methods.h"

// Distance of a convex hull from the origin, after Gilbert, Johnson & Keerthi, "A fast procedure
// for computing the distance between complex objects in three-dimensional space", 1988.
namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

struct Candidate {
  Vector3d point;
  std::vector<Vector3d> supports;
};

// The following functions project the origin onto the affine hull of some corners. They replace
// `best` by this foot if it lies between the corners and is nearer. Degenerate sets are skipped,
// because their subsets are tested, too.
void offer(Candidate& best, const Vector3d& foot, std::vector<Vector3d> supports) {
  if (foot.squaredNorm() < best.point.squaredNorm()) best = {foot, std::move(supports)};
}

void offer_segment(Candidate& best, const Vector3d& a, const Vector3d& b) {
  const Vector3d edge = b - a;
  const double length2 = edge.squaredNorm();
  const double along = -a.dot(edge);
  if (along > 0.0 && along < length2) offer(best, a + edge * (along / length2), {a, b});
}

void offer_triangle(Candidate& best, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  const double norm2 = normal.squaredNorm();
  const bool between =
      normal.dot(b.cross(c)) > 0.0 && normal.dot(c.cross(a)) > 0.0 && normal.dot(a.cross(b)) > 0.0;
  if (norm2 > 0.0 && between) offer(best, normal * (normal.dot(a) / norm2), {a, b, c});
}

Candidate find_nearest_on_simplex(const std::vector<Vector3d>& corners) {
  Candidate best{corners[0], {corners[0]}};
  const std::size_t n = corners.size();
  for (std::size_t a = 0; a < n; ++a) {
    offer(best, corners[a], {corners[a]});
    for (std::size_t b = a + 1; b < n; ++b) {
      offer_segment(best, corners[a], corners[b]);
      for (std::size_t c = b + 1; c < n; ++c) {
        offer_triangle(best, corners[a], corners[b], corners[c]);
      }
    }
  }
  return best;
}

// Returns the distance of the origin from the nearest face of a tetrahedron; not positive if the
// origin is outside.
double depth_in_tetrahedron(const std::vector<Vector3d>& corners) {
  double depth = 1.0;
  for (std::size_t apex = 0; apex < 4; ++apex) {
    const Vector3d& a = corners[(apex + 1) % 4];
    const Vector3d& b = corners[(apex + 2) % 4];
    const Vector3d& c = corners[(apex + 3) % 4];
    Vector3d outward = (b - a).cross(c - a);
    const double height = outward.dot(corners[apex] - a);
    if (height == 0.0) return 0.0;
    if (height > 0.0) outward = -outward;
    depth = std::min(depth, outward.dot(a) / outward.norm());
  }
  return depth;
}

}  // namespace

Vector3d compute_normal(const Triangle& facet) {
  // Starts from the corner between the two shorter edges, because the difference of close points is
  // exact.
  std::size_t apex = 0;
  double longest = -1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double opposite = (facet[(i + 1) % 3] - facet[(i + 2) % 3]).squaredNorm();
    if (opposite > longest) longest = opposite, apex = i;
  }
  const Vector3d& corner = facet[apex];
  return (facet[(apex + 1) % 3] - corner).cross(facet[(apex + 2) % 3] - corner);
}

OriginInHull locate_origin(DirectionIndex& occluded) {
  const Vector3d first = occluded.nearest(Vector3d::UnitX()).direction;
  Candidate best{first, {first}};
  // The distance decreases in every iteration, so no set of supports occurs twice.
  while (true) {
    const double distance = best.point.norm();
    if (distance <= cap_tolerance) return {best.point, best.supports, false};
    const Vector3d support = occluded.nearest(-best.point / distance).direction;
    const bool known =
        std::find(best.supports.begin(), best.supports.end(), support) != best.supports.end();
    if (known) return {best.point, best.supports, false};

    std::vector<Vector3d> corners = best.supports;
    corners.push_back(support);
    if (corners.size() == 4) {
      const double depth = depth_in_tetrahedron(corners);
      if (depth >= 0.0) return {Vector3d::Zero(), corners, depth > cap_tolerance};
    }
    Candidate next = find_nearest_on_simplex(corners);
    // Due to rounding, the new support is not nearer to the origin.
    if (next.point.norm() >= distance) return {best.point, best.supports, false};
    best = std::move(next);
  }
}

}  // namespace skycap::geometry
