/// Whether a mission file's own geofence goes with its route, and with the mission's.
#pragma once

#include "flight/export/mavlink_files.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/flown_route.h"

namespace skycap::flight {

/// Stretches that leave or enter an area of the file, named by their items, and volumes of the
/// mission that a file with a geofence does not hold. Fences have no heights: a no-fly volume that
/// a stretch passes over or under cannot be in it, and one with a ceiling need not. Formats without
/// a geofence hold none: there the route alone is judged.
Problems check_fence(const MissionFile& file, const FlownRoute& route, const FlightFacts& facts);

}  // namespace skycap::flight
