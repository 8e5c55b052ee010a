/// District files specify which buildings of a map are surveyed and how.
/// docs/reference/batch-files.md documents the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/wizard/site_request.h"

namespace skycap::missions::batch {

/// Selection of map objects as targets. Targets must meet all given criteria.
struct TargetChoice {
  std::vector<std::string> ids;
  std::map<std::string, std::string> attributes;
  std::vector<wizard::Click> within;  ///< two opposite corners of a box, or empty
  std::optional<wizard::Click> near;
  double distance = 0.0;  ///< maximum distance between `near` and a target's bounding box [m]
};

struct DistrictFile {
  std::string name;
  std::filesystem::path file;   ///< path of the district file
  wizard::SiteRequest request;  ///< input files, their interpretation, and the vehicle; no target
  TargetChoice targets;
  /// Targets closer to each other than this are surveyed together [m].
  double merge_distance = 0.5;
  std::vector<wizard::Click> pads;  ///< take-off points; empty: proposed automatically
  std::string planner = "skycap";   ///< name of one of batch::methods()
  std::uint64_t seed = 1;
  std::vector<config::KeyOverride> set;  ///< overrides for the missions of all targets
};

/// Reads a district file. Throws Error{bad_file} if it cannot be read. Throws Error{bad_config}
/// with "FILE:LINE: key KEY: what is wrong; what would be right".
DistrictFile read_district(const std::filesystem::path& file);

/// Parses a district from a string. `name` is the file name in messages; paths are relative to its
/// folder. Throws Error{bad_config} as read_district().
DistrictFile parse_district(const std::string& text, const std::string& name);

}  // namespace skycap::missions::batch
