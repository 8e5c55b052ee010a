/// What is in a mission's handle.
#pragma once

#include <filesystem>

#include "missions/file/mission.h"
#include "missions/library/mission.h"

namespace skycap::missions::library {

struct Mission::Contents {
  file::Mission mission;
  std::filesystem::path folder;  ///< where relative paths start
};

}  // namespace skycap::missions::library
