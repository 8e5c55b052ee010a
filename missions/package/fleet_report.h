/// What a fleet's mission says of itself.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "flight/fleet/separation.h"
#include "missions/package/fleet_mission.h"

namespace skycap::missions::package {

/// Some lines for the user; with `is_verbose` also how far the fleet is from its lower bounds.
std::string fleet_text(const FleetMission& fleet, bool is_verbose);

/// `flight.fleet` of summary.json; `goal` is the text of flight.fleet_goal.
nlohmann::ordered_json fleet_json(const FleetMission& fleet, const std::string& goal,
                                  const flight::SeparationRule& asked);

}  // namespace skycap::missions::package
