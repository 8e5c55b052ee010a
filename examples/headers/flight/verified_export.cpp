#include <skycap/flight/verified_export.h>

#include "example.h"
#include "tower.h"

// Writes a mission file only if its content, read back, keeps the clearance.
const Example verified_export_example("flight/verified_export", [] {
  const skycap::flight::KnownSpace space = tower_space();
  const skycap::flight::FlightPlan plan = tower_plan(space);
  const auto written =
      export_flight(plan, skycap::flight::Format::geojson, space, scratch("tower.geojson"));
  return written.min_clearance >= plan.clearance - skycap::flight::rounding_bound &&
         std::filesystem::exists(scratch("tower.geojson"));
});
