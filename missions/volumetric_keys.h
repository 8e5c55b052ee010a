/// The keys volumetric.* of the mission file.
#pragma once

#include <vector>

#include "missions/mission_keys.h"

namespace skycap::missions {

std::vector<Key> volumetric_keys();

}  // namespace skycap::missions
