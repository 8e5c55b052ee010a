/// The keys that decide how a survey goes, as text: what an unfinished survey has to be continued
/// with, and what makes two trials the same.
#pragma once

#include <string>
#include <vector>

#include "missions/config/mission.h"

namespace skycap::missions::config {

struct Setting {
  std::string key;
  std::string value;  ///< as a mission file would say it; "-" if it is left to be derived
};

/// All keys in the order of the table but name, seed and threads, and what publications report.
std::vector<Setting> survey_settings(const config::Mission& mission);

}  // namespace skycap::missions::config
