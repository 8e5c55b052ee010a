/// How little time a fleet could need at all.
#pragma once

#include "flight/fleet/fleet_problem.h"

namespace skycap::flight {

struct FleetBound {
  double makespan = 0.0;  ///< the last of the vehicles lands no sooner [s]
  double flown = 0.0;     ///< all together are no shorter in the air [s]
};

/// No way of sharing the stations out is faster than this, if no part of a flight is faster than
/// `least` says; energy is not asked about. The makespan is the greatest of collection_bound(), of
/// the longest flight to a single station and back, and, over all numbers k of vehicles that may
/// fly, of the least k-th part of what k closed tours through all stations take at least: the
/// 1-tree bound of Held & Karp with k copies of the pad, which are not neighbours. In the last two
/// a vehicle's own pad and speed count as those of the best placed and the fastest one. `makespan`
/// is what some fleet attains; no bound is above it.
FleetBound fleet_bound(const FleetProblem& least, double makespan);

}  // namespace skycap::flight
