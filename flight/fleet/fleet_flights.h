/// Simulation of all sorties of a fleet together, repeated with random wind and random deviations
/// from the timetable within the tolerance.
#pragma once

#include <cstddef>
#include <span>

#include "flight/fleet/separation.h"
#include "flight/monte_carlo/monte_carlo.h"

namespace skycap::flight {

/// Sortie from its file, with its timetable entry.
struct FleetFlight {
  SimulatedMission mission;
  std::size_t vehicle = 0;
  double start = 0.0;  ///< Start time [s].
};

struct FleetFlightTest {
  std::size_t simulated = 0;  ///< Number of simulations. Fewer than requested after a stop.
  std::size_t nearer = 0;     ///< Number of simulations with a distance below `limit`.
  double limit = 0.0;         ///< Minimum permitted distance [m].
  double min_separation =
      0.0;  ///< Minimum distance of two vehicles in the air, over all simulations [m].
  double median_min_separation = 0.0;  ///< Median of the minimum distances of the simulations [m].
};

/// Simulates all sorties options.flights times. The minimum distance is that of the rule, which
/// refers to planned positions, minus `strays`, the total position error of two vehicles [m]. No
/// vehicle is recalled. The result does not depend on the number of threads.
FleetFlightTest fly_fleet(std::span<const FleetFlight> flights, const SeparationRule& rule,
                          double strays, const FlyTestOptions& options);

}  // namespace skycap::flight
