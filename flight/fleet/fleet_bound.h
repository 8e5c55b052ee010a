/// Lower bounds on the flight times of a fleet.
#pragma once

#include "flight/fleet/fleet_problem.h"

namespace skycap::flight {

struct FleetBound {
  double makespan = 0.0;           ///< Lower bound on the time of the last landing [s].
  double total_flight_time = 0.0;  ///< Lower bound on the total time in the air [s].
};

/// Returns the bounds, if no part of a flight is faster than in `lower_bound`. Energy is ignored.
/// The makespan bound is the maximum of three: collection_bound(), the longest flight to a single
/// waypoint and back, and the minimum over k of a bound for k vehicles. The latter is 1/k of the
/// 1-tree bound of Held & Karp with k pad copies that are not adjacent. The last two use the best
/// pad and the maximum speed for all vehicles. `makespan` [s] is the value of a known solution; no
/// bound exceeds it.
FleetBound fleet_bound(const FleetProblem& lower_bound, double makespan);

}  // namespace skycap::flight
