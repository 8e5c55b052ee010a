/// Objective of a fleet's flights.
#pragma once

namespace skycap::flight {

enum class FleetGoal {
  makespan,           ///< Time until the last landing.
  total_flight_time,  ///< Total time of all vehicles in the air.
};

}  // namespace skycap::flight
