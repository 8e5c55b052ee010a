/// Private contents of api::Mission.
#pragma once

#include <filesystem>

#include "missions/api/mission.h"
#include "missions/config/mission_setup.h"

namespace skycap::missions::api {

struct Mission::Contents {
  config::MissionSetup setup;
  std::filesystem::path folder;  ///< base of relative paths
};

}  // namespace skycap::missions::api
