/// What ArduCopter and PX4 do with a MAVLink mission, item by item.
///
/// Every command is looked up in command_table.h; what is not there, and what an autopilot would
/// skip, is a problem of that item. Heights count item by item: frames 0 and 5 from sea level, 3
/// and 6 from home, which is the mission's pad whatever the file says, as autopilots take home from
/// where they are armed; a file that says another home is refused.
///
/// Sources: those of command_table.h.
#pragma once

#include "flight/export/mavlink_files.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/flown_route.h"

namespace skycap::flight {

/// Flies the file in its dialect, else in the vehicle's. Places are rounded as the autopilot's
/// memory rounds them. Throws Error{bad_config} if heights count from sea level and the site's
/// undulation is unknown.
FlownRoute interpret(const MissionFile& file, const FlightFacts& facts);

}  // namespace skycap::flight
