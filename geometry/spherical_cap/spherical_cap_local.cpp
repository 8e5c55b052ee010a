#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/pose/pose.h"
#include "geometry/spherical_cap/spherical_cap_methods.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

// Every gap between neighbouring members of Q is a minimum of h, so the first steps of a descent
// must be larger than such gaps. A failed step reduces the step size by `step_shrinkage`; the
// descent ends at `last_step`.
constexpr double small_step = 0.3;  // [rad]
constexpr double large_step = 1.0;  // [rad]
constexpr double step_shrinkage = 0.7;
constexpr double last_step = 0.01;  // [rad]
constexpr int max_hops = 10;        // from a cap to an adjacent cap; usually only a few

struct Probe {
  Vector3d direction;  // s
  Vector3d active;     // the member of Q nearest to s
  double cosine;       // h(s)
};

// Evaluates h. Uses the members of Q found before where they are sufficient, which avoids most
// queries of the index.
class Prober {
 public:
  explicit Prober(DirectionIndex& index) : index_(index) {}

  Probe at(const Vector3d& s) {
    const auto [member, cosine] = index_.nearest(s);
    if (std::find(known_.begin(), known_.end(), member) == known_.end()) known_.push_back(member);
    return {s, member, cosine};
  }

  // Evaluates h at s. Returns nullopt unless h(s) < `cosine`.
  std::optional<Probe> at_if_below(const Vector3d& s, double cosine) {
    if (nearest_known(s).cosine >= cosine) return std::nullopt;
    const Probe probe = at(s);
    return probe.cosine < cosine ? std::optional(probe) : std::nullopt;
  }

  // Returns a member with s.q > `cosine`, not necessarily the nearest to s, or nullopt if none
  // exists.
  std::optional<Vector3d> beyond(const Vector3d& s, double cosine) {
    const auto [known, known_cosine] = nearest_known(s);
    if (known_cosine > cosine) return known;
    const Probe probe = at(s);
    return probe.cosine > cosine ? std::optional(probe.active) : std::nullopt;
  }

 private:
  DirectionIndex::Nearest nearest_known(const Vector3d& s) const {
    DirectionIndex::Nearest nearest{Vector3d::Zero(), -std::numeric_limits<double>::infinity()};
    for (const Vector3d& q : known_) {
      const double cosine = q.dot(s);
      if (cosine > nearest.cosine) nearest = {q, cosine};
    }
    return nearest;
  }

  DirectionIndex& index_;
  std::vector<Vector3d> known_;
};

Vector3d turned_away(const Vector3d& s, const Vector3d& from, double angle) {
  const Vector3d tangent = s.dot(from) * s - from;
  const Vector3d away = tangent.norm() > 1e-9 ? Vector3d(tangent.normalized()) : any_orthogonal(s);
  return (std::cos(angle) * s + std::sin(angle) * away).normalized();
}

// Moves from `best` repeatedly away from the nearest member of Q, in decreasing steps.
Probe descend(Prober& occluded, Probe best, double step) {
  while (step > last_step) {
    const Vector3d ahead = turned_away(best.direction, best.active, step);
    if (const auto next = occluded.at_if_below(ahead, best.cosine)) {
      best = *next;
    } else {
      step *= step_shrinkage;
    }
  }
  return best;
}

// Returns n with n.q = 1 at each corner: the normal of the facet divided by its distance from the
// origin.
std::optional<Vector3d> compute_polar(const Triangle& facet) {
  const Vector3d normal = compute_normal(facet);
  const double height = normal.dot(facet[0]);
  if (height == 0.0) return std::nullopt;
  return normal / height;
}

// Returns l with s = l0 a + l1 b + l2 c.
std::optional<Vector3d> coordinates(const Triangle& facet, const Vector3d& s) {
  const Vector3d bc = facet[1].cross(facet[2]);
  const double determinant = facet[0].dot(bc);
  if (determinant == 0.0) return std::nullopt;
  return Vector3d(s.dot(bc), s.dot(facet[2].cross(facet[0])), s.dot(facet[0].cross(facet[1]))) /
         determinant;
}

// Finds the facet of conv(Q) that intersects the ray along s with the dual simplex method. Among
// the triangles with corners in Q around the ray, this is the one with no member of Q outside. It
// solves the linear program max n.s with n.q <= 1 for all q, whose solution is the polar of the
// facet. Returns nullopt if rounding errors prevent a solution.
std::optional<Triangle> facet_around(Prober& occluded, const Vector3d& s) {
  // Three artificial corners on the axes around s, near the origin, form the initial triangle. The
  // origin is deeper inside conv(Q), so that members of Q replace all of them.
  constexpr double tiny = 0.1 * cap_tolerance;
  constexpr double pivot_tolerance =
      1e-12;                       // larger than the rounding error of the corners' own distance
  constexpr int max_pivots = 500;  // usually about ten
  Triangle facet;
  for (int axis = 0; axis < 3; ++axis) {
    facet[axis] = std::copysign(tiny, s[axis]) * Vector3d::Unit(axis);
  }
  for (int pivot = 0; pivot < max_pivots; ++pivot) {
    const auto polar = compute_polar(facet);
    if (!polar) return std::nullopt;
    const double distance = 1.0 / polar->norm();
    const auto entering = occluded.beyond(*polar * distance, distance + pivot_tolerance);
    if (!entering) return facet;

    const auto ray_coordinates = coordinates(facet, s),
               entering_coordinates = coordinates(facet, *entering);
    if (!ray_coordinates || !entering_coordinates) return std::nullopt;
    int leaving = -1;
    double smallest = 0.0;
    for (int i = 0; i < 3; ++i) {
      if ((*entering_coordinates)[i] <= 0.0) continue;
      const double ratio = std::max((*ray_coordinates)[i], 0.0) / (*entering_coordinates)[i];
      if (leaving < 0 || ratio < smallest) leaving = i, smallest = ratio;
    }
    if (leaving < 0) return std::nullopt;
    facet[leaving] = *entering;
  }
  return std::nullopt;
}

struct Minimum {
  Probe probe;
  std::optional<Triangle> facet;  // nullopt if rounding errors ended the search
};

// Replaces s repeatedly by the normal of the facet around it, until it does not change. This solves
// the published program exactly, with its only non-convex constraint e <= n.n linearised at s in
// each iteration. h decreases in every iteration.
Minimum settle_on_facet(Prober& occluded, const Probe& start) {
  Minimum best{start, std::nullopt};
  while (true) {
    const auto facet = facet_around(occluded, best.probe.direction);
    const auto polar = facet ? compute_polar(*facet) : std::nullopt;
    if (!polar) return best;
    const auto next = occluded.at_if_below(polar->normalized(), best.probe.cosine);
    if (!next) return best;
    best = {*next, facet};
    const auto foot = coordinates(*facet, next->direction);
    if (foot && foot->minCoeff() >= 0.0) return best;  // the facet contains its own normal
  }
}

// Steps across each side of the facet, away from the opposite corner, and settles there. Returns
// the largest cap found.
Minimum best_neighbour(Prober& occluded, const Minimum& minimum) {
  Minimum best = minimum;
  if (!minimum.facet) return best;
  for (const Vector3d& corner : *minimum.facet) {
    const Vector3d ahead = turned_away(minimum.probe.direction, corner, small_step);
    const Minimum settled = settle_on_facet(occluded, occluded.at(ahead));
    if (settled.probe.cosine < best.probe.cosine - cap_tolerance) best = settled;
  }
  return best;
}

}  // namespace

SphericalCap local_empty_cap(DirectionIndex& index, const Vector3d& known_clear) {
  Prober occluded(index);
  const Probe start = occluded.at(known_clear);
  Minimum best = settle_on_facet(occluded, start);
  for (const double step : {small_step, large_step}) {
    const Minimum settled = settle_on_facet(occluded, descend(occluded, start, step));
    if (settled.probe.cosine < best.probe.cosine) best = settled;
  }
  for (int hop = 0; hop < max_hops; ++hop) {
    const Minimum next = best_neighbour(occluded, best);
    if (next.probe.cosine == best.probe.cosine) break;
    best = next;
  }
  return {best.probe.direction, best.probe.cosine};
}

}  // namespace skycap::geometry
