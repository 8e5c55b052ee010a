/// What the parts of a fleet's flights take, by the very legs that its routes will be made of.
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

/// Certifies every way from and to a pad, and the legs between stations that are among each other's
/// nearest; of other legs it counts what least_costs() does until somebody wants to fly them. All
/// vehicles fly the same ways between stations, in both directions, unless a way home asks for
/// another one.
class CertifiedCosts {
 public:
  /// The stations' view indices differ. `space` must outlive this object; what is free and the
  /// clearance are the same for all. The result does not depend on `threads` (0: all processors).
  CertifiedCosts(std::vector<Station> stations, const std::vector<FleetMember>& members,
                 const FreeSpace& space, unsigned threads = 0);
  ~CertifiedCosts();

  /// A station that a vehicle cannot serve takes infinite energy.
  const FleetProblem& problem() const { return problem_; }
  /// The same by least_costs() alone: no flight whatever is faster.
  const FleetProblem& least() const { return least_; }

  /// Stations that no vehicle can serve.
  std::vector<Unreached> unreached() const;

  /// Certifies what legs of a split are not; whether there were any.
  bool certify(const FleetSplit& split);

  /// The stations of a vehicle in that order, with the ways between them, which are certified: what
  /// plan_route() makes a route of that takes what problem() says.
  std::vector<Station> stations_of(std::size_t vehicle, std::span<const std::uint32_t> order) const;

 private:
  /// Two stations, the lower number first.
  struct Pair {
    std::uint32_t low, high;
    // clang-tidy 14 takes the zero that its results are compared with for a null pointer.
    auto operator<=>(const Pair&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  using Way = std::vector<Eigen::Vector3d>;
  struct Vehicle;

  /// From the lower number to the higher one, and back; nothing if the vehicle serves only one.
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
