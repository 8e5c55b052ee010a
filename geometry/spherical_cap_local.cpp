#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "geometry/pose.h"
#include "geometry/spherical_cap_methods.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

// Every gap between neighbouring members of Q is a minimum of h, so a descent must start with
// steps larger than such gaps. These are the first step [rad], what a failed step leaves of it, and
// how many steps may be tried.
constexpr double first_step = 0.3;
constexpr double step_shrinkage = 0.7;
constexpr int max_steps = 60;

struct Probe {
  Vector3d direction;  // s
  Vector3d active;     // the member of Q nearest to s
  double cosine;       // h(s)
};

Probe probe(DirectionIndex& occluded, const Vector3d& direction) {
  const auto nearest = occluded.nearest(direction);
  return {direction, nearest.direction, nearest.cosine};
}

// From `start` straight away from the nearest member of Q, again and again, in shrinking steps.
Probe descend(DirectionIndex& occluded, const Vector3d& start) {
  Probe best = probe(occluded, start);
  double step = first_step;
  for (int i = 0; i < max_steps; ++i) {
    Vector3d away = best.cosine * best.direction - best.active;  // tangent at best.direction
    away = away.norm() > 1e-9 ? Vector3d(away.normalized()) : any_orthogonal(best.direction);
    const Vector3d ahead = std::cos(step) * best.direction + std::sin(step) * away;
    const Probe next = probe(occluded, ahead.normalized());
    if (next.cosine < best.cosine) {
      best = next;
    } else {
      step *= step_shrinkage;
    }
  }
  return best;
}

// The n with n.q = 1 at each corner: the facet's normal over its distance from the origin.
std::optional<Vector3d> polar_of(const Triangle& facet) {
  const Vector3d normal = normal_of(facet);
  const double height = normal.dot(facet[0]);
  if (height == 0.0) return std::nullopt;
  return normal / height;
}

// l with s = l0 a + l1 b + l2 c.
std::optional<Vector3d> coordinates(const Triangle& facet, const Vector3d& s) {
  const Vector3d bc = facet[1].cross(facet[2]);
  const double determinant = facet[0].dot(bc);
  if (determinant == 0.0) return std::nullopt;
  return Vector3d(s.dot(bc), s.dot(facet[2].cross(facet[0])), s.dot(facet[0].cross(facet[1]))) /
         determinant;
}

// The facet of conv(Q) that the ray along s passes through, by the dual simplex method: of all
// triangles with corners in Q around the ray, the one that no member of Q lies outside of. It
// solves the linear program max n.s with n.q <= 1 for all q, whose solution is the facet's polar.
std::optional<Triangle> facet_around(DirectionIndex& occluded, const Vector3d& s) {
  // Three stand-ins near the origin, on the axes about s, make the first triangle. As the origin
  // lies deeper inside conv(Q) than they do, members of Q replace them all.
  constexpr double tiny = 0.1 * cap_tolerance;
  Triangle facet;
  for (int axis = 0; axis < 3; ++axis) {
    facet[axis] = std::copysign(tiny, s[axis]) * Vector3d::Unit(axis);
  }
  for (int pivots = 0; pivots < 200; ++pivots) {
    const auto polar = polar_of(facet);
    if (!polar) return std::nullopt;
    const auto outermost = occluded.nearest(polar->normalized());
    if (outermost.cosine * polar->norm() <= 1.0 + 1e-12) return facet;

    const auto of_ray = coordinates(facet, s);
    const auto of_new = coordinates(facet, outermost.direction);
    if (!of_ray || !of_new) return std::nullopt;
    int leaving = -1;
    double smallest = 0.0;
    for (int i = 0; i < 3; ++i) {
      if ((*of_new)[i] <= 0.0) continue;
      const double ratio = std::max((*of_ray)[i], 0.0) / (*of_new)[i];
      if (leaving < 0 || ratio < smallest) leaving = i, smallest = ratio;
    }
    if (leaving < 0) return std::nullopt;
    facet[leaving] = outermost.direction;
  }
  return std::nullopt;
}

// Replaces s by the normal of the facet around it until that is the same: the published program
// with its one non-convex constraint e <= n.n linearised at s, solved exactly, again and again. h
// falls with every round.
Probe settle_on_facet(DirectionIndex& occluded, Probe best) {
  while (true) {
    const auto facet = facet_around(occluded, best.direction);
    const auto polar = facet ? polar_of(*facet) : std::nullopt;
    if (!polar) return best;
    const Probe next = probe(occluded, polar->normalized());
    if (!(next.cosine < best.cosine)) return best;
    best = next;
    const auto foot = coordinates(*facet, best.direction);
    if (foot && foot->minCoeff() >= 0.0) return best;  // the facet is around its own normal
  }
}

}  // namespace

SphericalCap local_empty_cap(DirectionIndex& occluded, const Vector3d& known_clear) {
  const Probe settled = settle_on_facet(occluded, descend(occluded, known_clear));
  return {settled.direction, settled.cosine};
}

}  // namespace skycap::geometry
