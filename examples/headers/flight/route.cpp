#include <skycap/flight/route.h>

#include "example.h"
#include "tower.h"

// Plans a route from one side of a tower to the other. It leads around the tower and keeps the
// clearance.
const Example route_example("flight/route", [] {
  const skycap::flight::Route route = tower_route(tower_space());
  const double straight = 30.0;  // through the tower
  return route.capture_points.size() == 2 && route.legs[0].length > straight &&
         route.min_clearance >= route.clearance;
});
