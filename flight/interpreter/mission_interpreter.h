/// Behaviour of ArduCopter and PX4 for a MAVLink mission, item by item.
///
/// Every command is looked up in command_table.h. Unknown commands, and those that an autopilot
/// would skip, are problems of that item. The altitude reference is set per item: frames 0 and 5
/// are AMSL, 3 and 6 are above home. Home is the mission's pad, because autopilots set it where
/// they are armed; a file with a different home is rejected.
///
/// Sources: those of command_table.h.
#pragma once

#include "flight/export/mavlink_files.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Interprets the file in its own dialect, or in the vehicle's if it specifies none. Positions are
/// rounded like those in the autopilot's memory. Throws Error{bad_config} if heights are AMSL and
/// the site's geoid undulation is unknown.
InterpretedRoute interpret(const MavlinkMission& file, const FlightFacts& facts);

}  // namespace skycap::flight
