#include <algorithm>

#include <skycap/flight/clearance.h>
#include <skycap/flight/flight_plan.h>
#include <skycap/flight/obstacles.h>
#include <skycap/flight/route.h>

#include "example.h"

// The first sortie of a route as a writer of files sees it.
const Example flight_plan_example("flight/flight_plan", [] {
  const skycap::flight::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  const skycap::flight::KnownSpace space(
      {.mesh = skycap::flight::surface(tower), .ground_height = 0.0});
  const auto route = plan_route({{.view = skycap::geometry::look_at({-15, 0, 15}, {0, 0, 15})},
                                 {.view = skycap::geometry::look_at({15, 0, 15}, {0, 0, 15})}},
                                {}, space, nullptr, {.takeoff = {-30, -30, 0}});
  const skycap::flight::Site site{.origin = {51.7534, -1.2540, 110.0}, .geoid_undulation = 47.0};
  const auto plan = flight_plan(route, 0, "tower", site);
  const auto shots =
      std::ranges::count_if(plan.waypoints, [](const auto& w) { return w.shots > 0; });
  return shots == 2 && flight_time(plan) > route.length / plan.vehicle.max_speed;
});
