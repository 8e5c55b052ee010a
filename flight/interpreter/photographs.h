/// Consistency of a file's photos with the mission's views.
#pragma once

#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Returns the problems of the photos by item: holds that are too short, directions that the gimbal
/// cannot reach, and intervals or speeds that the photo camera does not allow. If the mission's
/// views are known, photos that match no view are also problems.
Problems check_photographs(const InterpretedRoute& route, const FlightFacts& facts);

/// Returns a problem for each view of the mission without a photo in the file, by position.
Problems missing_photographs(const InterpretedRoute& route, const FlightFacts& facts);

}  // namespace skycap::flight
