/// What a DJI aircraft does with a waypoint mission of DJI's WPML format.
///
/// Aircraft fly waylines.wpml; Pilot 2 makes it anew from template.kml when a mission is edited. So
/// both are held to the same rules. Elements that are not known here are refused.
///
/// Sources: DJI Cloud API documentation, chapter DJI WPML; the return-to-home sections of DJI's
/// manuals.
#pragma once

#include "flight/export/wpml_file.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/flown_route.h"

namespace skycap::flight {

/// Flies a good .kmz file's waylines: up from the pad to the security height or the first
/// waypoint's, level to it, through all of them with a stop at each, and down to the pad. Throws
/// Error{bad_config} if heights count from sea level and the site's undulation is unknown.
FlownRoute interpret(const KmzContent& kmz, const FlightFacts& facts);

}  // namespace skycap::flight
