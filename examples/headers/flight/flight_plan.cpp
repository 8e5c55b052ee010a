#include <algorithm>

#include <skycap/flight/flight_plan.h>

#include "example.h"
#include "tower.h"

// Creates the plan of a route's first sortie, the input for all file formats.
const Example flight_plan_example("flight/flight_plan", [] {
  const skycap::flight::KnownSpace space = tower_space();
  const skycap::flight::Route route = tower_route(space);
  const skycap::flight::Site site{.origin = {51.7534, -1.2540, 110.0}, .geoid_undulation = 47.0};
  const skycap::flight::FlightPlan plan = flight_plan(route, 0, "tower", site);
  const auto captures =
      std::ranges::count_if(plan.waypoints, [](const auto& w) { return w.captures > 0; });
  return captures == 2 && flight_time(plan) > route.length / plan.vehicle.max_speed;
});
