/// Reads mission files and checks each key by itself. docs/mission_file.md is the manual of the
/// format; derived/resolved_mission.h checks the keys against each other and completes them.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "missions/config/mission.h"

namespace skycap::missions::config {

/// A value given beside the file that takes the place of the file's, such as --seed 3.
struct KeyOverride {
  std::string origin;  ///< what messages call it, such as "--seed"
  std::string path;    ///< the key, such as "seed"
  std::string value;   ///< as the file would say it
};

/// A mission as far as its file says it, and where the file says what.
struct MissionFile {
  std::string name;  ///< what messages call the file
  Mission mission;   ///< presets and keys; all else is as by default
  std::map<std::string, std::string, std::less<>> places;  ///< of the keys given: "FILE:LINE", or
                                                           ///< an override's origin

  bool gives(std::string_view key) const;

  /// Throws Error{bad_config}, one line: "FILE:LINE: key KEY: WHAT". A key that is not given stands
  /// in the first line.
  [[noreturn]] void refuse(std::string_view key, const std::string& what) const;
};

/// Reads a mission. Presets come first, keys override them wherever they stand. Every value is
/// checked to be of its key's type and in its range.
///
/// Throws Error{bad_file} if the file cannot be read, and Error{bad_config} with one line,
/// "FILE:LINE: key PATH: what is wrong; what would be right", for the first thing that is unknown,
/// missing, mistyped or out of range.
MissionFile read_mission_file(const std::filesystem::path& file,
                              const std::vector<KeyOverride>& overrides = {});

/// The same for a mission that is already in memory; `name` stands for the file in messages.
MissionFile parse_mission_file(const std::string& text, const std::string& name,
                               const std::vector<KeyOverride>& overrides = {});

}  // namespace skycap::missions::config
