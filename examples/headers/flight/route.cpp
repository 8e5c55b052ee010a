#include <skycap/flight/clearance.h>
#include <skycap/flight/obstacles.h>
#include <skycap/flight/route.h>

#include "example.h"

// From one side of a tower to the other: the way leads around it, and keeps its distance.
const Example route_example("flight/route", [] {
  const skycap::flight::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  const skycap::flight::KnownSpace space(
      {.mesh = skycap::flight::surface(tower), .ground_height = 0.0});
  const auto route = plan_route({{.view = skycap::geometry::look_at({-15, 0, 15}, {0, 0, 15})},
                                 {.view = skycap::geometry::look_at({15, 0, 15}, {0, 0, 15})}},
                                {}, space, nullptr, {.takeoff = {-30, -30, 0}});
  // The straight way leads through the tower.
  return route.stations.size() == 2 && route.legs[0].length > 30.0 &&
         route.min_clearance >= route.clearance;
});
