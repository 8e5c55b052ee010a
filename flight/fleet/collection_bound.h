/// How soon the last of a fleet's vehicles could have landed, by what each could collect till then.
///
/// Give every station a prize, all together 1. In a time t a vehicle collects prizes of at most
/// M(t), over all closed tours that are no longer; so stations cannot all be visited by vehicles
/// whose M(t) add up to less than 1. M(t) is found exactly by dynamic programming over tours that
/// may come to a station again, though not from the one they went to from it (q-routes without
/// 2-cycles; Christofides, Mingozzi & Toth 1981). Prizes are moved towards stations that the best
/// such tours leave out (subgradient ascent of the Lagrangean dual).
#pragma once

#include "flight/fleet/fleet_problem.h"

namespace skycap::flight {

/// No way of sharing the stations out lands everybody sooner, if no part of a flight is faster than
/// `least` says; energy is not asked about. At most `makespan`, which some fleet attains. Times are
/// cut down to multiples of 1/4000 of that, of a greater share where there are many stations.
/// Deterministic. The ascent takes at most about 4e9 steps, in fewer rounds where there are many
/// stations; 0 if there are too many for a single one.
double collection_bound(const FleetProblem& least, double makespan);

}  // namespace skycap::flight
