/// Reads mission files and checks each key by itself. docs/reference/mission-file.md is the manual
/// of the format; config/resolve.h checks the keys against each other and completes them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/config/mission_document.h"

namespace skycap::missions::config {

/// Reads a mission. Names of version 0.1 are accepted (former_names.h). Presets come first, keys
/// override them wherever they stand. Every value is checked to be of its key's type and in its
/// range.
///
/// Throws Error{bad_file} if the file cannot be read, and Error{bad_config} with one line,
/// "FILE:LINE: key PATH WHAT IS WRONG; what would be right", for the first thing that is unknown,
/// missing, mistyped or out of range.
MissionDocument read_mission_document(const std::filesystem::path& file,
                                      const std::vector<KeyOverride>& overrides = {});

/// The same for a mission that is already in memory; `name` stands for the file in messages.
MissionDocument parse_mission_document(const std::string& text, const std::string& name,
                                       const std::vector<KeyOverride>& overrides = {});

/// Gives keys of a document other values, as if its file said so. Throws as the above.
void override_keys(MissionDocument& document, const std::vector<KeyOverride>& changes);

}  // namespace skycap::missions::config
