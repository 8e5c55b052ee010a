/// What a fleet's flights are to be short in.
#pragma once

namespace skycap::flight {

enum class FleetGoal {
  makespan,  ///< until the last vehicle has landed
  flown,     ///< the time of all vehicles in the air together
};

}  // namespace skycap::flight
