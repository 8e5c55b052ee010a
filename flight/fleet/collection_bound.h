/// Lower bound on the makespan of a fleet, from the prizes that each vehicle can collect in a given
/// time.
///
/// Every waypoint has a prize, with a total of 1. Within time t, a vehicle collects at most M(t),
/// the maximum over all closed tours of at most that duration. The vehicles cannot visit all
/// waypoints if their M(t) add up to less than 1. Dynamic programming computes M(t) exactly over a
/// relaxed set of tours. These may revisit a waypoint, but not directly after leaving it (q-routes
/// without 2-cycles; Christofides, Mingozzi & Toth 1981). Prizes are shifted towards the waypoints
/// that the best such tours omit (subgradient ascent of the Lagrangian dual).
#pragma once

#include "flight/fleet/fleet_problem.h"

namespace skycap::flight {

/// Returns a lower bound on the makespan [s], if no part of a flight is faster than in
/// `lower_bound`. Energy is ignored. The bound is at most `makespan`, which a known solution
/// attains. Times are rounded down to multiples of 1/4000 of it, or of a larger fraction with many
/// waypoints.
///
/// Deterministic. The ascent takes at most about 4e9 steps, in fewer iterations with many
/// waypoints. Returns 0 if there are too many waypoints for one iteration.
double collection_bound(const FleetProblem& lower_bound, double makespan);

}  // namespace skycap::flight
