/// Compatibility with result files of version 0.1. Will be removed in version 0.3.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace skycap::missions::package {

/// Renames fields and values of result files of version 0.1, such as summary.json, to their current
/// names. Current results remain unchanged.
void use_current_fields(nlohmann::ordered_json& results);

}  // namespace skycap::missions::package
