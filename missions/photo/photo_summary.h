/// Printed summary of a photo mission.
#pragma once

#include <string>

#include "missions/config/mission_setup.h"
#include "missions/photo/photo_mission.h"

namespace skycap::missions::photo {

/// Returns some lines about the plan, the missing surface, and the patterns compared with the plan.
/// The flight is not included.
std::string plan_text(const config::MissionSetup& setup, const PhotoMission& mission);

/// Returns the words for users of a reason, such as "outside the gimbal's range".
std::string describe(survey::photo::MissingReason reason);

/// Returns a line "Warning: ..." for each warning.
std::string warnings_text(const PhotoMission& mission);

}  // namespace skycap::missions::photo
