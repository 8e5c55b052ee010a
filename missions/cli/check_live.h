/// `skycap check` for live missions, and its warning about sensors that are used outside their
/// range.
#pragma once

#include <optional>
#include <string>

#include "missions/cli/console.h"
#include "missions/config/mission_setup.h"

namespace skycap::missions::cli {

/// Returns a warning if `view_distance` [m] is outside the `useful_range` of the mission's camera
/// preset, in which its depths are accurate. Otherwise returns an empty string.
std::string range_warning(const config::MissionSetup& setup, double view_distance);

/// Checks the keys of a live mission for consistency. Prints the derived values: view distance,
/// sensor, region of interest, limits and first view. No scene is simulated. Returns the exit code:
/// 0 without problems, otherwise 1.
int check_live(const std::string& file, const config::MissionSetup& setup, const Console& console);

}  // namespace skycap::missions::cli
