/// The records of journals as JSON texts of one line. For the journals' sources.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "missions/support/identity.h"

namespace skycap::missions::support {

/// Format of the records of a survey, simulated or live, as the "format" of their identity. Since
/// format 2 a planner keeps the limits of views itself, so that views that they refuse are not
/// counted as unreachable. Since format 3 keys and fields have the names of version 0.2. Earlier
/// journals have no format.
inline constexpr int journal_format = 3;

/// Names that are not UTF-8 are shown with a replacement character.
std::string journal_line(const nlohmann::ordered_json& json);

/// The first record: version, seed, all keys that decide the survey or scan, and what else does,
/// such as a digest of what is surveyed.
std::string identity_text(const Identity& run, const nlohmann::ordered_json& more);

/// Throws Error{bad_file}, beginning with `file` and ending with `cure`, unless the two first
/// records are of one survey or scan, and `found` has the format that is wanted.
void require_same_survey(const std::string& file, const std::string& found,
                         const std::string& wanted, const std::string& cure);

}  // namespace skycap::missions::support
