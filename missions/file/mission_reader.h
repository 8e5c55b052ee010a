/// Reads and checks mission files. docs/mission_file.md is the manual of the format.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "missions/file/mission.h"

namespace skycap::missions::file {

/// A value given beside the file that takes the place of the file's, such as --seed 3.
struct KeyOverride {
  std::string origin;  ///< what messages call it, such as "--seed"
  std::string path;    ///< the key, such as "seed"
  std::string value;   ///< as the file would say it
};

/// Reads a mission. Presets come first, keys override them wherever they stand. Every field is
/// checked; the planner's parameters by SeeConfig::validate() too.
///
/// Throws Error{bad_file} if the file cannot be read, and Error{bad_config} with one line,
/// "FILE:LINE: key PATH: what is wrong; what would be right", for the first thing that is unknown,
/// missing, mistyped, out of range or contradictory.
Mission read_mission(const std::filesystem::path& file,
                     const std::vector<KeyOverride>& overrides = {});

/// The same for a mission that is already in memory; `name` stands for the file in messages.
Mission parse_mission(const std::string& text, const std::string& name,
                      const std::vector<KeyOverride>& overrides = {});

}  // namespace skycap::missions::file
