#include <skycap/flight/export.h>

#include "example.h"
#include "tower.h"

// Writes a sortie as text in one of the formats, and reads the positions in that text.
const Example export_example("flight/export", [] {
  const skycap::flight::FlightPlan plan = tower_plan(tower_space());
  const auto geojson = skycap::flight::format_named("geojson");
  const auto positions = read_positions(write(plan, geojson), geojson, plan.site, plan.pad);
  return !positions.empty() && (positions.front() - plan.waypoints.front().position).norm() <
                                   skycap::flight::rounding_bound;
});
