/// The keys volumetric.* of the mission file.
#pragma once

#include <vector>

#include "missions/file/mission_keys.h"

namespace skycap::missions::file {

std::vector<Key> volumetric_keys();

}  // namespace skycap::missions::file
