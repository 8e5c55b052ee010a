/// Text and JSON summary of a fleet's mission.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "flight/fleet/separation.h"
#include "missions/package/fleet_mission.h"

namespace skycap::missions::package {

/// Returns several lines for the user. With `is_verbose`, these include the gap to the lower
/// bounds.
std::string fleet_text(const FleetMission& fleet, bool is_verbose);

/// Returns `flight.fleet` of summary.json. `goal` is the value of flight.fleet_goal.
nlohmann::ordered_json fleet_json(const FleetMission& fleet, const std::string& goal,
                                  const flight::SeparationRule& asked);

}  // namespace skycap::missions::package
