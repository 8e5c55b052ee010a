/// Encodes journal records as single-line JSON. Private to the journal implementations.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "missions/support/identity.h"

namespace skycap::missions::support {

/// Format version of survey records, the "format" field of their identity. Since format 2, planners
/// apply the view limits, so that views outside the limits are not counted as unreachable. Since
/// format 3, keys and fields have the names of version 0.2. Earlier journals have no format field.
inline constexpr int journal_format = 3;

/// Returns a record as one line. Invalid UTF-8 is replaced by the replacement character.
std::string journal_line(const nlohmann::ordered_json& json);

/// Returns the first record: version, seed and all keys that determine the survey or scan. `more`
/// contains further inputs, such as a checksum of the scene.
std::string identity_text(const Identity& run, const nlohmann::ordered_json& more);

/// Throws Error{bad_file} unless the first records `found` and `expected` identify the same survey
/// or scan and have the same format. The message begins with `file` and ends with `cure`.
void require_same_survey(const std::string& file, const std::string& found,
                         const std::string& expected, const std::string& cure);

}  // namespace skycap::missions::support
