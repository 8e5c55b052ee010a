/// Text representation of a resolved mission, for users and tests.
#pragma once

#include <string>

#include "missions/config/mission_setup.h"

namespace skycap::missions::config {

/// Returns YAML with the completed value of every key (`keys`) and the values derived from several
/// keys (`derived`). Units of `derived` are metres, seconds and degrees.
std::string setup_text(const MissionSetup& setup);

}  // namespace skycap::missions::config
