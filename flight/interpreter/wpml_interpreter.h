/// Behaviour of a DJI aircraft for a waypoint mission in the WPML format.
///
/// Aircraft fly waylines.wpml. When a mission is edited, Pilot 2 regenerates it from template.kml,
/// so both files must satisfy the same rules. Unknown elements are rejected.
///
/// Sources: DJI Cloud API documentation, chapter DJI WPML; the return-to-home sections of DJI's
/// manuals.
#pragma once

#include "flight/export/wpml_file.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Interprets the waylines of a valid .kmz file. The aircraft climbs from the pad to the security
/// height or that of the first waypoint and flies level to it. It then flies through all waypoints
/// with a stop at each, and descends to the pad. Throws Error{bad_config} if heights are AMSL and
/// the site's geoid undulation is unknown.
InterpretedRoute interpret(const KmzContent& kmz, const FlightFacts& facts);

}  // namespace skycap::flight
