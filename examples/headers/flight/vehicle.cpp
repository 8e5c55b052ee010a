#include <skycap/flight/vehicle.h>
#include <skycap/geometry/error.h>

#include "example.h"

// Sets the properties of a vehicle. Invalid values are rejected.
const Example vehicle_example("flight/vehicle", [] {
  skycap::flight::Vehicle vehicle{.name = "survey quad", .radius = 0.4, .max_speed = 8.0};
  vehicle.validate();
  vehicle.battery_wh = -1.0;
  try {
    vehicle.validate();
  } catch (const skycap::Error&) {
    return true;  // the message names the value
  }
  return false;
});
