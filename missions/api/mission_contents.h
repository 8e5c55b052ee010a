/// What is in a mission's handle.
#pragma once

#include <filesystem>

#include "missions/api/mission.h"
#include "missions/config/mission_setup.h"

namespace skycap::missions::api {

struct Mission::Contents {
  config::MissionSetup setup;
  std::filesystem::path folder;  ///< where relative paths start
};

}  // namespace skycap::missions::api
