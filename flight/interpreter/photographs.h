/// Whether the photographs of a flown file are those that the mission wants.
#pragma once

#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/flown_route.h"

namespace skycap::flight {

/// Holds that are too short, directions that the gimbal does not have, and, where the mission's
/// views are known, photographs that are none of them, by item.
Problems check_photographs(const std::vector<FlownStop>& stops, const FlightFacts& facts);

}  // namespace skycap::flight
