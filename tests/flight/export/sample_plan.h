/// Small flight at a small site, for the tests of the formats.
#pragma once

#include "flight/clearance/obstacles.h"
#include "flight/export/flight_plan.h"
#include "flight/route/route.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {

/// Returns a building of 20 x 20 x 15 m on flat ground, inside a fence. The flight passes next to a
/// heliport and above a low shed zone.
Obstacles sample_site();

/// Returns a plan for four capture points around the building, near Oxford, for this vehicle at 2 m
/// clearance.
FlightPlan sample_plan(const Vehicle& vehicle);

/// Returns a plan for six photos of the south side of the building, one every 3 m in a row at a
/// height of 8 m. The camera's motion blur limits the speed to 2.5 m/s. The vehicle stops at each
/// photo.
FlightPlan photo_row_plan(const Vehicle& vehicle);

/// Returns a plan from one side of the building to the other and back, with corners, in this flight
/// style.
FlightPlan corner_plan(FlightStyle style);

}  // namespace skycap::flight
