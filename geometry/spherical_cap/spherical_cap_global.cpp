#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <queue>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <Eigen/Geometry>

#include "geometry/spherical_cap/clearings.h"
#include "geometry/spherical_cap/spherical_cap_methods.h"

// Finds the largest empty cap with an expanding polytope. The polytope is the convex hull of a
// small subset W of Q. Its facet nearest to the origin bounds the largest cap that contains no
// member of W, which is an upper bound of the result. The member of Q deepest inside that cap is
// added to W, and the hull grows there. If there is no such member, the cap contains no member of
// Q. CGAL's exact predicates decide on which side of a facet a point is, so that the hull is valid
// for all inputs.
//
// If Q has holes, W stays small. Otherwise, W would grow to most of Q before no facet can improve
// the best cap. From a certain size on, the hull therefore grows only where clearings.h cannot
// exclude the centre of a larger cap.
namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr double emptiness_tolerance = 1e-9;  // depth inside a cap up to which it counts as empty
constexpr std::size_t members_without_clearings =
    100;  // holes are usually found with about 60 members

Kernel::Point_3 to_cgal(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }

class Polytope {
 public:
  struct Facet {
    std::array<std::uint32_t, 3> corners;     // counter-clockwise seen from outside
    std::array<std::uint32_t, 3> neighbours;  // [i] is across the edge from corner i to i + 1
    Vector3d normal;                          // outward unit vector
    double
        distance;  // signed distance of the plane from the origin; positive if the origin is inside
    bool is_alive;
  };

  /// Computes the hull of `points`, which must contain four points that are not coplanar.
  explicit Polytope(const std::vector<Vector3d>& points);

  const Facet& facet(std::uint32_t f) const { return facets_[f]; }
  std::size_t size() const {
    return facets_.size();
  }  ///< including dead facets, so that it never decreases
  std::size_t members() const { return points_.size(); }

  bool is_outside(const Vector3d& point, std::uint32_t f) const {
    const auto& [a, b, c] = facets_[f].corners;
    return CGAL::orientation(to_cgal(points_[a]), to_cgal(points_[b]), to_cgal(points_[c]),
                             to_cgal(point)) == CGAL::POSITIVE;
  }

  /// Adds a point outside of the live facet `seen`.
  void add(const Vector3d& point, std::uint32_t seen);

 private:
  std::uint32_t add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void start_with_tetrahedron();

  std::vector<Vector3d> points_;
  std::vector<Facet> facets_;
};

std::uint32_t Polytope::add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  Facet facet{{a, b, c}, {}, Vector3d::Zero(), std::numeric_limits<double>::infinity(), true};
  const Vector3d normal = compute_normal({points_[a], points_[b], points_[c]});
  // Facets too thin for double precision are assigned an infinite distance, because they never
  // bound a largest cap.
  if (normal.squaredNorm() > 0.0) {
    facet.normal = normal.normalized();
    facet.distance = facet.normal.dot(points_[a]);
  }
  facets_.push_back(facet);
  return static_cast<std::uint32_t>(facets_.size() - 1);
}

Polytope::Polytope(const std::vector<Vector3d>& points) : points_(points) {
  start_with_tetrahedron();
  for (const Vector3d& point : points) {
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      if (!facets_[f].is_alive || !is_outside(point, f)) continue;
      add(point, f);
      break;
    }
  }
}

// Finds four points that are not coplanar: the first one, a different one, one off their line, and
// one off their plane.
void Polytope::start_with_tetrahedron() {
  const auto count = static_cast<std::uint32_t>(points_.size());
  const auto p = [this](std::uint32_t i) { return to_cgal(points_[i]); };
  std::uint32_t b = 1;
  while (b < count && points_[b] == points_[0]) ++b;
  std::uint32_t c = b + 1;
  while (c < count && CGAL::collinear(p(0), p(b), p(c))) ++c;
  std::uint32_t d = c + 1;
  while (d < count && CGAL::coplanar(p(0), p(b), p(c), p(d))) ++d;
  assert(d < count);
  if (CGAL::orientation(p(0), p(b), p(c), p(d)) == CGAL::POSITIVE) std::swap(b, c);
  add_facet(0, b, c);
  add_facet(0, c, d);
  add_facet(0, d, b);
  add_facet(b, d, c);
  facets_[0].neighbours = {2, 3, 1};
  facets_[1].neighbours = {0, 3, 2};
  facets_[2].neighbours = {1, 3, 0};
  facets_[3].neighbours = {2, 1, 0};
}

void Polytope::add(const Vector3d& point, std::uint32_t seen) {
  // The facets visible from the point are connected, and their border is a single closed line of
  // edges.
  struct Edge {
    std::uint32_t from, to, beyond;  // corners, and the adjacent facet that stays
  };
  std::vector<Edge> horizon;
  std::vector<std::uint32_t> front{seen};
  facets_[seen].is_alive = false;
  for (std::size_t i = 0; i < front.size(); ++i) {
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t beyond = facets_[front[i]].neighbours[side];
      if (!facets_[beyond].is_alive) continue;  // already in the front
      if (is_outside(point, beyond)) {
        facets_[beyond].is_alive = false;
        front.push_back(beyond);
      } else {
        const auto& corners = facets_[front[i]].corners;
        horizon.push_back({corners[side], corners[(side + 1) % 3], beyond});
      }
    }
  }

  const auto apex = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
  const auto first = static_cast<std::uint32_t>(facets_.size());
  for (const Edge& edge : horizon) {
    const std::uint32_t added = add_facet(edge.from, edge.to, apex);
    facets_[added].neighbours[0] = edge.beyond;
    auto& beyond = facets_[edge.beyond];
    for (std::size_t side = 0; side < 3; ++side) {
      if (beyond.corners[side] == edge.to && beyond.corners[(side + 1) % 3] == edge.from) {
        beyond.neighbours[side] = added;
      }
    }
  }
  // Connects the sides of the new facets at the apex: each begins where the previous one ends.
  for (std::size_t i = 0; i < horizon.size(); ++i) {
    for (std::size_t next = 0; next < horizon.size(); ++next) {
      if (horizon[next].from != horizon[i].to) continue;
      facets_[first + i].neighbours[1] = static_cast<std::uint32_t>(first + next);
      facets_[first + next].neighbours[2] = static_cast<std::uint32_t>(first + i);
    }
  }
}

// Orders equal caps by distance from `known_clear`, then by coordinates.
bool is_preferred(const Vector3d& a, const Vector3d& b, const Vector3d& known_clear) {
  const double difference = a.dot(known_clear) - b.dot(known_clear);
  if (std::abs(difference) > cap_tolerance) return difference > 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(a[axis] - b[axis]) > cap_tolerance) return a[axis] < b[axis];
  }
  return false;
}

std::vector<Vector3d> first_members(DirectionIndex& occluded, std::span<const Vector3d> seeds) {
  std::vector<Vector3d> members(seeds.begin(), seeds.end());
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        members.push_back(occluded.nearest(Vector3d(x, y, z).normalized()).direction);
      }
    }
  }
  return members;
}

}  // namespace

std::optional<SphericalCap> largest_empty_cap(DirectionIndex& occluded,
                                              std::span<const Vector3d> seeds,
                                              const Vector3d& known_clear, double largest_cosine) {
  Polytope polytope(first_members(occluded, seeds));
  struct Task {
    double distance;
    std::uint32_t facet;
    bool operator>(const Task& other) const {
      return distance != other.distance ? distance > other.distance : facet > other.facet;
    }
  };
  std::priority_queue<Task, std::vector<Task>, std::greater<>> nearest_facets;
  std::uint32_t queued = 0;
  std::vector<SphericalCap> caps;  // empty caps, largest first
  double bound = largest_cosine;   // or h in the best direction found
  std::optional<Clearings> clearings;
  while (true) {
    for (; queued < polytope.size(); ++queued) {
      if (!polytope.facet(queued).is_alive) continue;
      nearest_facets.push({polytope.facet(queued).distance, queued});
    }
    if (nearest_facets.empty()) break;
    const auto [distance, facet] = nearest_facets.top();
    nearest_facets.pop();
    if (!polytope.facet(facet).is_alive) continue;
    if (distance > bound + cap_tolerance) break;
    if (!clearings && polytope.members() > members_without_clearings) {
      clearings = find_clearings(occluded, bound);
      bound = std::min(bound, clearings->cosine);
    }
    if (clearings && !clearings->meet(polytope.facet(facet).normal, distance)) continue;
    const auto deepest = occluded.nearest(polytope.facet(facet).normal);
    bound = std::min(bound, deepest.cosine);
    if (deepest.cosine > distance + emptiness_tolerance &&
        polytope.is_outside(deepest.direction, facet)) {
      polytope.add(deepest.direction, facet);
    } else {
      caps.push_back({polytope.facet(facet).normal, deepest.cosine});
    }
  }

  if (caps.empty()) return std::nullopt;
  SphericalCap best = *std::min_element(
      caps.begin(), caps.end(),
      [](const SphericalCap& a, const SphericalCap& b) { return a.cosine < b.cosine; });
  const double largest = best.cosine;
  for (const SphericalCap& cap : caps) {
    if (cap.cosine <= largest + cap_tolerance &&
        is_preferred(cap.direction, best.direction, known_clear)) {
      best = cap;
    }
  }
  return best;
}

}  // namespace skycap::geometry
