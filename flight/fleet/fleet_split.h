/// Shares an order of stations out among vehicles: route first, split second, then exchanges by
/// chance (simulated annealing) and by gain.
///
/// The split of a given order is exact (dynamic programming, as Beasley 1983 for one vehicle; for
/// the longest of several, as the linear partition problem). The exchange then moves stations,
/// swaps them and swaps the tails of two vehicles' orders (2-opt*, Potvin & Rousseau 1995) as long
/// as that helps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flight/fleet/fleet_goal.h"
#include "flight/fleet/fleet_problem.h"

namespace skycap::flight {

/// What one vehicle flies, sortie after sortie.
struct FleetPart {
  std::vector<std::uint32_t> stations;  ///< in the order flown
  double time = 0.0;                    ///< of all its sorties [s]
};

struct FleetSplit {
  std::vector<FleetPart> parts;  ///< by vehicle; empty if some station can be served by none
  double makespan = 0.0;         ///< the longest of their times [s]
  double flown = 0.0;            ///< all of them together [s]
};

/// What a vehicle takes for stations in that order, in one sortie if its battery allows that, else
/// in the fastest split; infinite if it cannot serve them.
double part_time(const FleetVehicle& vehicle, std::span<const std::uint32_t> stations);

/// The best split of the order into one run of stations for each vehicle, the first vehicle's
/// first: the least of the goal, and of such splits the least of the other. O(count^2) part_time()
/// for each vehicle.
FleetSplit split_among(const FleetProblem& problem, std::span<const std::uint32_t> order,
                       FleetGoal goal);

/// The order's sorties, as the first vehicle would fly them, each given to the vehicle that will
/// have landed first with it, the longest sortie first (Graham 1969, "longest processing time").
FleetSplit share_sorties(const FleetProblem& problem, std::span<const std::uint32_t> order);

/// The split after exchanges between vehicles, and within, until none helps. Never worse by the
/// goal. Deterministic.
FleetSplit exchanged(const FleetProblem& problem, FleetSplit split, FleetGoal goal);

/// The best that random exchanges between vehicles, and within, came by, at first with losses and
/// ever less so. A fixed number of moves, 30,000 for each station (fewer from hundreds on);
/// deterministic: each `chain` draws other numbers.
FleetSplit annealed(const FleetProblem& problem, FleetSplit split, FleetGoal goal,
                    std::uint64_t chain = 0);

/// Annealings that are seldom all in vain: of a city block's 36 stations every fourth or so comes
/// by the best known.
inline constexpr std::size_t thorough = 12;

/// The best of both splits of an order, each after its exchanges, and of so many annealings of the
/// better one, exchanged again. Empty parts if there is none. The same for any number of `threads`
/// (0: all processors).
FleetSplit share_among(const FleetProblem& problem, std::span<const std::uint32_t> order,
                       FleetGoal goal, std::size_t chains = thorough, unsigned threads = 0);

}  // namespace skycap::flight
