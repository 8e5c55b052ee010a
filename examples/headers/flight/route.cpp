#include <skycap/flight/route.h>

#include "example.h"
#include "tower.h"

// From one side of a tower to the other: the way leads around it, and keeps its distance.
const Example route_example("flight/route", [] {
  const skycap::flight::Route route = tower_route(tower_space());
  const double straight = 30.0;  // through the tower
  return route.capture_points.size() == 2 && route.legs[0].length > straight &&
         route.min_clearance >= route.clearance;
});
