/// Consistency of a file's photos with the mission's views.
#pragma once

#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Holds that are too short, directions that the gimbal does not have, photographs that follow one
/// another faster or are taken at a higher speed than the photo camera allows, and, where the
/// mission's views are known, photographs that are none of them, by item.
Problems check_photographs(const InterpretedRoute& route, const FlightFacts& facts);

/// Views of the mission that the file takes no photograph of, by their positions.
Problems missing_photographs(const InterpretedRoute& route, const FlightFacts& facts);

}  // namespace skycap::flight
