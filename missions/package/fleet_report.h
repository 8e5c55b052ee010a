/// What a fleet's mission says of itself.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "missions/package/fleet_mission.h"

namespace skycap::missions::package {

/// Some lines for the user.
std::string fleet_text(const FleetMission& fleet);

/// `flight.fleet` of summary.json.
nlohmann::ordered_json fleet_json(const config::Mission& mission, const FleetMission& fleet);

}  // namespace skycap::missions::package
