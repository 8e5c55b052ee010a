/// Reads mission files and checks each key separately. docs/reference/mission-file.md documents the
/// format. config/resolve.h checks combinations of keys and derives missing values.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/config/mission_document.h"

namespace skycap::missions::config {

/// Reads a mission file and applies `overrides`. Names of version 0.1 are accepted
/// (former_names.h). Keys override presets regardless of their order in the file. The type and
/// range of every value are checked.
///
/// Throws Error{bad_file} if the file cannot be read. Throws Error{bad_config} for the first
/// unknown, missing, mistyped or out-of-range key. The message is one line: "FILE:LINE: key PATH
/// WHAT IS WRONG; what would be right".
MissionDocument read_mission_document(const std::filesystem::path& file,
                                      const std::vector<KeyOverride>& overrides = {});

/// Reads a mission from a string. `name` is the file name in messages. Throws Error{bad_config} as
/// read_mission_document().
MissionDocument parse_mission_document(const std::string& text, const std::string& name,
                                       const std::vector<KeyOverride>& overrides = {});

/// Applies overrides to a document. Throws Error{bad_config} for unknown keys and invalid values.
void override_keys(MissionDocument& document, const std::vector<KeyOverride>& changes);

}  // namespace skycap::missions::config
