/// Converts key values to JSON that a mission file accepts unchanged.
#pragma once

#include <nlohmann/json.hpp>

#include "missions/config/key.h"

namespace skycap::missions::config {

nlohmann::ordered_json setting_json(const KeyValue& value);

}  // namespace skycap::missions::config
