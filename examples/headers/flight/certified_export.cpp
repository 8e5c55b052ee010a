#include <skycap/flight/certified_export.h>
#include <skycap/flight/export.h>
#include <skycap/flight/obstacles.h>
#include <skycap/flight/route.h>

#include "example.h"

// A file that is written because what it says, read back, keeps its distance.
const Example certified_export_example("flight/certified_export", [] {
  const skycap::flight::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  const skycap::flight::KnownSpace space(
      {.mesh = skycap::flight::surface(tower), .ground_height = 0.0});
  const auto route = plan_route({{.view = skycap::geometry::look_at({-15, 0, 15}, {0, 0, 15})},
                                 {.view = skycap::geometry::look_at({15, 0, 15}, {0, 0, 15})}},
                                {}, space, nullptr, {.takeoff = {-30, -30, 0}});
  const skycap::flight::Site site{.origin = {51.7534, -1.2540, 110.0}, .geoid_undulation = 47.0};
  const auto plan = flight_plan(route, 0, "tower", site);
  const auto written =
      export_flight(plan, skycap::flight::Format::geojson, space, scratch("tower.geojson"));
  return written.min_clearance >= route.clearance - skycap::flight::rounding_bound &&
         std::filesystem::exists(scratch("tower.geojson"));
});
