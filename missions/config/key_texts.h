/// The keys of a document as texts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "missions/config/mission_document.h"
#include "missions/support/identity.h"

namespace skycap::missions::config {

/// All keys in the order of the table but name, seed and threads, and what publications report;
/// then what the prior data holds. `vehicle_checksum` is the CRC-32 of the vehicle's description
/// where that is a file.
std::vector<support::Setting> survey_settings(const MissionDocument& document,
                                              const std::optional<std::uint32_t>& vehicle_checksum);

/// The text of all keys that decide what of a scene is visible and attainable, and of what the
/// prior data holds; each line begins with a line feed.
std::string attainable_inputs(const MissionDocument& document);

}  // namespace skycap::missions::config
