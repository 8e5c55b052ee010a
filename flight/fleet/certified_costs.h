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

#include "flight/fleet/fleet_costs.h"
#include "flight/fleet/fleet_problem.h"
#include "flight/fleet/fleet_split.h"
#include "flight/paths/path.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// Verifies all legs from and to pads, and the legs between each waypoint and its nearest
/// neighbours. Other legs have the cost of least_costs() until a split uses them. All vehicles fly
/// the same paths between waypoints, in both directions, unless a return requires a different one.
class CertifiedCosts {
 public:
  /// The view indices of `stations` must differ. Keeps a reference to `space`. Free space and
  /// clearance are common to all vehicles. The result does not depend on `threads` (0: all
  /// processors).
  CertifiedCosts(std::vector<Station> stations, const std::vector<FleetMember>& members,
                 const FreeSpace& space, unsigned threads = 0);
  ~CertifiedCosts();

  /// Returns the costs. A waypoint that a vehicle cannot serve has infinite energy.
  const FleetProblem& problem() const { return problem_; }
  /// Returns the costs of least_costs() for all legs: a lower bound for every flight.
  const FleetProblem& least() const { return least_; }

  /// Returns the waypoints that no vehicle can serve.
  std::vector<Unreached> unreached() const;

  /// Verifies the remaining legs of a split. Returns true if there were any.
  bool certify(const FleetSplit& split);

  /// Returns the waypoints of a vehicle in the given order, with their verified paths. A route that
  /// plan_route() makes from them has the costs of problem().
  std::vector<Station> stations_of(std::size_t vehicle, std::span<const std::uint32_t> order) const;

 private:
  /// Two waypoints, in ascending order.
  struct Pair {
    std::uint32_t low, high;
    // clang-tidy 14 mistakes the zero in comparisons of the result for a null pointer.
    auto operator<=>(const Pair&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  using Way = std::vector<Eigen::Vector3d>;
  struct Vehicle;

  /// Legs from the lower to the higher index, and back. Empty unless the vehicle serves both
  /// waypoints.
  struct BothWays {
    std::optional<Leg> up, down;
  };

  void take_ends(std::size_t vehicle);
  std::vector<Pair> near_pairs() const;
  bool certify(std::vector<Pair> pairs);
  std::vector<Way> found(const std::vector<Pair>& pairs) const;
  BothWays both_ways(std::size_t vehicle, const Pair& pair, const Way& way) const;
  void take_leg(std::size_t vehicle, std::uint32_t from, std::uint32_t to, std::optional<Leg> leg);

  std::vector<Station> stations_;
  const FreeSpace& space_;
  unsigned threads_;
  double clearance_;
  PathOptions path_options_;
  std::vector<std::unique_ptr<Vehicle>> vehicles_;
  std::set<Pair> certified_;
  FleetProblem problem_, least_;
};

}  // namespace skycap::flight
