/// A district file: which buildings of a map are surveyed, and how. docs/reference/batch-files.md
/// is the manual of the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/wizard/wishes.h"

namespace skycap::missions::batch {

/// Which of a map's things are targets: those that meet all that is given.
struct TargetChoice {
  std::vector<std::string> ids;
  std::map<std::string, std::string> attributes;
  std::vector<wizard::Click> within;  ///< two opposite corners of a box, or none
  std::optional<wizard::Click> near;
  double distance = 0.0;  ///< of their boxes from `near`, at most [m]
};

struct DistrictFile {
  std::string name;
  std::filesystem::path file;  ///< itself
  wizard::Wishes wishes;       ///< files, how they are read, vehicle; but no target
  TargetChoice targets;
  double merge_distance = 0.5;      ///< targets nearer to each other are surveyed as one [m]
  std::vector<wizard::Click> pads;  ///< empty: they are proposed
  std::string planner = "skycap";   ///< of batch::contestants()
  std::uint64_t seed = 1;
  std::vector<config::KeyOverride> set;  ///< in the missions of all targets
};

/// Throws Error{bad_file} if it cannot be read, and Error{bad_config}, "FILE:LINE: key KEY: what is
/// wrong; what would be right".
DistrictFile read_district(const std::filesystem::path& file);

/// The same of a text; `name` stands for the file in messages, and paths count from its folder.
DistrictFile parse_district(const std::string& text, const std::string& name);

}  // namespace skycap::missions::batch
