/// Fields of the results of version 0.1 that version 0.2 reads. Removed with 0.3.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace skycap::missions::package {

/// Gives the fields of results of version 0.1, such as summary.json, and the words in them their
/// current names. Current results stay as they are.
void use_current_fields(nlohmann::ordered_json& results);

}  // namespace skycap::missions::package
