/// Values of keys as JSON, which a mission file takes as they stand.
#pragma once

#include <nlohmann/json.hpp>

#include "missions/config/key.h"

namespace skycap::missions::config {

nlohmann::ordered_json setting_json(const KeyValue& value);

}  // namespace skycap::missions::config
