/// Assignment of ordered waypoints to vehicles: route first, cluster second, followed by random
/// exchanges (simulated annealing) and improving exchanges.
///
/// The split of a given order is exact: dynamic programming, as in Beasley 1983 for one vehicle,
/// and as in the linear partition problem for the makespan. The exchanges then move waypoints, swap
/// them and swap the tails of two vehicles' orders (2-opt*, Potvin & Rousseau 1995) while that
/// improves the goal.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flight/fleet/fleet_goal.h"
#include "flight/fleet/fleet_problem.h"

namespace skycap::flight {

/// Part of one vehicle, in one or more sorties.
struct FleetPart {
  std::vector<std::uint32_t> capture_points;  ///< In flight order.
  double time = 0.0;                          ///< Total time of its sorties [s].
};

struct FleetSplit {
  /// One part per vehicle. Empty if no vehicle can serve one of the waypoints.
  std::vector<FleetPart> parts;
  double makespan = 0.0;           ///< Maximum time of all vehicles [s].
  double total_flight_time = 0.0;  ///< Total time of all vehicles [s].
};

/// Returns the time of a vehicle for waypoints in the given order [s]: one sortie if the battery
/// suffices, otherwise the fastest split. Infinite if the vehicle cannot serve them.
double part_time(const FleetVehicle& vehicle, std::span<const std::uint32_t> capture_points);

/// Returns the best split of the order into one run of waypoints per vehicle, in the order of
/// vehicles. It minimises the goal and, among equal splits, the other objective. Needs O(count^2)
/// calls of part_time() per vehicle.
FleetSplit split_among(const FleetProblem& problem, std::span<const std::uint32_t> order,
                       FleetGoal goal);

/// Splits the order into sorties of the first vehicle. Each sortie, longest first, is assigned to
/// the vehicle that finishes it first (Graham 1969, "longest processing time").
FleetSplit share_sorties(const FleetProblem& problem, std::span<const std::uint32_t> order);

/// Returns the split after exchanges between and within vehicles until none improves it. Never
/// worse in the goal. Deterministic.
FleetSplit exchanged(const FleetProblem& problem, FleetSplit split, FleetGoal goal);

/// Returns the best split found by simulated annealing with exchanges between and within vehicles.
/// The number of moves is fixed: 30,000 per waypoint, fewer for hundreds of waypoints.
/// Deterministic: `chain` selects the random numbers.
FleetSplit annealed(const FleetProblem& problem, FleetSplit split, FleetGoal goal,
                    std::uint64_t chain = 0);

/// Number of annealing chains that rarely all fail: with the 36 waypoints of a city block, about
/// one chain in four finds the best known split.
inline constexpr std::size_t thorough = 12;

/// Returns the best result for an order. Both splits are improved by exchanges. The better one is
/// then annealed in `chains` chains, each followed by exchanges. Parts are empty if no split
/// exists. The result does not depend on `threads` (0: all processors).
FleetSplit share_among(const FleetProblem& problem, std::span<const std::uint32_t> order,
                       FleetGoal goal, std::size_t chains = thorough, unsigned threads = 0);

}  // namespace skycap::flight
