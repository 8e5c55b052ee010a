/// Costs of the parts of a fleet's flights, from the legs that the routes will contain.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/fleet/fleet_costs.h"
#include "flight/fleet/fleet_problem.h"
#include "flight/fleet/fleet_split.h"
#include "flight/paths/path.h"
#include "flight/route/route.h"

namespace skycap::flight {

/// Verifies all legs from and to pads, and the legs between each waypoint and its nearest
/// neighbours. Other legs have the cost of lower_bound_costs() until a split uses them. All
/// vehicles fly the same paths between waypoints, in both directions, unless a return requires a
/// different one.
class VerifiedCosts {
 public:
  /// The view indices of `capture_points` must differ. Keeps a reference to `space`. Free space and
  /// clearance are common to all vehicles. The result does not depend on `threads` (0: all
  /// processors).
  VerifiedCosts(std::vector<CapturePoint> capture_points, const std::vector<FleetMember>& members,
                const FreeSpace& space, unsigned threads = 0);
  ~VerifiedCosts();

  /// Returns the costs. A waypoint that a vehicle cannot serve has infinite energy.
  const FleetProblem& problem() const { return problem_; }
  /// Returns the costs of lower_bound_costs() for all legs: a lower bound for every flight.
  const FleetProblem& lower_bound() const { return lower_bound_; }

  /// Returns the waypoints that no vehicle can serve.
  std::vector<Unreached> unreached() const;

  /// Verifies the remaining legs of a split. Returns true if there were any.
  bool verify_legs(const FleetSplit& split);

  /// Returns the waypoints of a vehicle in the given order, with their verified paths. A route that
  /// plan_route() makes from them has the costs of problem().
  std::vector<CapturePoint> ordered_capture_points(std::size_t vehicle,
                                                   std::span<const std::uint32_t> order) const;

 private:
  /// Two waypoints, in ascending order.
  struct Pair {
    std::uint32_t low, high;
    // clang-tidy 14 mistakes the zero in comparisons of the result for a null pointer.
    auto operator<=>(const Pair&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  using Polyline = std::vector<Eigen::Vector3d>;
  struct Vehicle;

  /// Legs from the lower to the higher index, and back. Empty unless the vehicle serves both
  /// waypoints.
  struct BothDirections {
    std::optional<Leg> up, down;
  };

  void add_end_legs(std::size_t vehicle);
  std::vector<Pair> near_pairs() const;
  bool verify_legs(std::vector<Pair> pairs);
  std::vector<Polyline> found(const std::vector<Pair>& pairs) const;
  BothDirections both_directions(std::size_t vehicle, const Pair& pair,
                                 const Polyline& approach_path) const;
  void add_leg(std::size_t vehicle, std::uint32_t from, std::uint32_t to, std::optional<Leg> leg);

  std::vector<CapturePoint> capture_points_;
  const FreeSpace& space_;
  unsigned threads_;
  double clearance_;
  PathOptions path_options_;
  std::vector<std::unique_ptr<Vehicle>> vehicles_;
  std::set<Pair> verified_;
  FleetProblem problem_, lower_bound_;
};

}  // namespace skycap::flight
