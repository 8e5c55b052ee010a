/// Printed summary of a photo mission.
#pragma once

#include <string>

#include "missions/config/mission_setup.h"
#include "missions/photo/photo_mission.h"

namespace skycap::missions::photo {

/// The plan with what will be missing and the patterns beside it, some lines; without the flight.
std::string plan_text(const config::MissionSetup& setup, const PhotoMission& mission);

/// A line "Warning: ..." for each warning.
std::string warnings_text(const PhotoMission& mission);

}  // namespace skycap::missions::photo
