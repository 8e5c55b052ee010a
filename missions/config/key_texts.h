/// The keys of a document as texts.
#pragma once

#include <string>
#include <vector>

#include "missions/config/mission_document.h"
#include "missions/support/identity.h"

namespace skycap::missions::config {

/// All keys in the order of the table but name, seed and threads, and what publications report;
/// then what the prior data holds.
std::vector<support::Setting> survey_settings(const MissionDocument& document);

/// The text of all keys that decide what of a scene is visible and attainable, and of what the
/// prior data holds; each line begins with a line feed.
std::string attainable_inputs(const MissionDocument& document);

}  // namespace skycap::missions::config
