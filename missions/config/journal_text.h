/// The records of journals as JSON texts of one line. For the journals' sources.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "missions/config/mission.h"

namespace skycap::missions::config {

/// Names that are not UTF-8 are shown with a replacement character.
std::string journal_line(const nlohmann::ordered_json& json);

/// The first record: version, seed, all keys that decide the survey or scan, and what else does,
/// such as a digest of what is surveyed.
std::string identity_text(const config::Mission& mission, const nlohmann::ordered_json& more);

/// Throws Error{bad_file}, beginning with `file`, unless the two first records are of one survey or
/// scan.
void require_same_survey(const std::string& file, const std::string& found,
                         const std::string& wanted, const std::string& cure);

}  // namespace skycap::missions::config
