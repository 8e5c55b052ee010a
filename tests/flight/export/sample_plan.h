/// A small flight over a small site, for the tests of the formats.
#pragma once

#include "flight/clearance/obstacles.h"
#include "flight/export/flight_plan.h"
#include "flight/route/route.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {

/// A building of 20 x 20 x 15 m on flat ground, a heliport that is flown past and a low shed zone
/// that is flown over, all inside a fence.
Obstacles sample_site();

/// Four stations around the building, near Oxford's meridian, planned for that vehicle at 2 m.
FlightPlan sample_plan(const Vehicle& vehicle);

/// Six photos of the building's south side, one every 3 m along a row at a height of 8 m, with a
/// camera whose motion blur limits the speed to 2.5 m/s. Stops at all of them.
FlightPlan photo_row_plan(const Vehicle& vehicle);

/// From one side of that building to the other and back: legs with corners, flown in that style.
FlightPlan corner_plan(FlightStyle style);

}  // namespace skycap::flight
