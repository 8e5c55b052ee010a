/// `skycap check` of live missions, and what it says of sensors that are used beyond their range.
#pragma once

#include <optional>
#include <string>

#include "missions/cli/console.h"
#include "missions/config/mission_setup.h"

namespace skycap::missions::cli {

/// A warning if the view distance is outside the depths that the mission's camera preset measures
/// well (`useful_range` of its description); empty otherwise. `view_distance` in metres.
std::string range_warning(const config::MissionSetup& setup, double view_distance);

/// Checks the keys of a live mission against each other and prints what follows from them: view
/// distance, sensor, region of interest, limits and first view. There is no scene that could be
/// surveyed. Exit code 0 without problems, otherwise 1.
int check_live(const std::string& file, const config::MissionSetup& setup, const Console& console);

}  // namespace skycap::missions::cli
