/// Consistency of a mission file's geofence with its route and with the mission.
#pragma once

#include "flight/export/mavlink_files.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Returns the pieces that leave or enter an area of the file's fence, with their items. Also
/// returns mission volumes that a file with a geofence lacks. Fences have no heights: the file
/// cannot contain a no-fly volume that a piece passes above or below, and may omit one with a
/// ceiling. For formats without a geofence, only the route is checked.
Problems check_fence(const MavlinkMission& file, const InterpretedRoute& route,
                     const FlightFacts& facts);

}  // namespace skycap::flight
