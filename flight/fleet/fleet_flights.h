/// A fleet's sorties flown in the simulator, all at once and many times: each time in another wind,
/// each vehicle early or late by some of the tolerance.
#pragma once

#include <cstddef>
#include <span>

#include "flight/fleet/separation.h"
#include "flight/fly_test/fly_test.h"

namespace skycap::flight {

/// A sortie as its file has it, and its place in the timetable.
struct FleetFlight {
  FlownMission mission;
  std::size_t vehicle = 0;
  double start = 0.0;  ///< [s]
};

struct FleetFlightTest {
  std::size_t flown = 0;      ///< times; fewer than asked for if it was stopped
  std::size_t nearer = 0;     ///< times that two vehicles came nearer than `limit`
  double limit = 0.0;         ///< [m]
  double least = 0.0;         ///< distance of any two in the air, in all flights [m]
  double least_median = 0.0;  ///< the median of the least of each [m]
};

/// Flies all sorties options.flights times. Two vehicles may come as near as the rule says less
/// `strays`, by which both together may be off their places: the rule is about places by plan.
/// Nobody is called home. The same for any number of threads.
FleetFlightTest fly_fleet(std::span<const FleetFlight> flights, const SeparationRule& rule,
                          double strays, const FlyTestOptions& options);

}  // namespace skycap::flight
