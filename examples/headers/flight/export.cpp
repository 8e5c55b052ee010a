#include <skycap/flight/clearance.h>
#include <skycap/flight/export.h>
#include <skycap/flight/obstacles.h>
#include <skycap/flight/route.h>

#include "example.h"

// A sortie as text in one of the formats, and the places that the text says.
const Example export_example("flight/export", [] {
  const skycap::flight::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  const skycap::flight::KnownSpace space(
      {.mesh = skycap::flight::surface(tower), .ground_height = 0.0});
  const auto route = plan_route({{.view = skycap::geometry::look_at({-15, 0, 15}, {0, 0, 15})},
                                 {.view = skycap::geometry::look_at({15, 0, 15}, {0, 0, 15})}},
                                {}, space, nullptr, {.takeoff = {-30, -30, 0}});
  const skycap::flight::Site site{.origin = {51.7534, -1.2540, 110.0}, .geoid_undulation = 47.0};
  const auto plan = flight_plan(route, 0, "tower", site);
  const auto places = places_of(write(plan, skycap::flight::Format::geojson),
                                skycap::flight::Format::geojson, site, plan.pad);
  return skycap::flight::format_named("kmz") == skycap::flight::Format::kmz && !places.empty() &&
         (places.front() - plan.waypoints.front().position).norm() < skycap::flight::rounding_bound;
});
