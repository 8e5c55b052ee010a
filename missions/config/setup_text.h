/// A resolved mission as text, for people and for tests.
#pragma once

#include <string>

#include "missions/config/mission_setup.h"

namespace skycap::missions::config {

/// YAML: the value of every key after it was completed (`keys`), and the values that follow from
/// several keys (`derived`) in metres, seconds and degrees.
std::string setup_text(const MissionSetup& setup);

}  // namespace skycap::missions::config
