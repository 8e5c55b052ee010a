/// Consistency of a file's photos with the mission's views.
#pragma once

#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Returns the problems per item: holds that are too short, directions outside the gimbal range,
/// and photos that match no view of the mission, if its views are known.
Problems check_photographs(const std::vector<InterpretedStop>& stops, const FlightFacts& facts);

}  // namespace skycap::flight
