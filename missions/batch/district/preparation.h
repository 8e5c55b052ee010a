/// From a district file to a mission for each target, and what the flight of all of them needs to
/// know. Written once, for all tasks that survey some of the targets each.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "missions/batch/campaign/campaign_file.h"
#include "missions/batch/district/district_file.h"
#include "missions/batch/district/outline.h"

namespace skycap::missions::batch {

/// What is surveyed as one.
struct PreparedTarget {
  std::string title;             ///< of its mission
  std::vector<std::string> ids;  ///< in the map
  std::vector<Ring> outlines;
  Eigen::AlignedBox3d box;      ///< of all of them
  Eigen::AlignedBox3d unknown;  ///< in which nothing is free before it is measured
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();  ///< of its survey
  std::string refusal;  ///< why there is no mission for it; empty: there is
};

struct Prepared {
  std::string digest;  ///< of the district's file, and of all that it names
  std::vector<Eigen::Vector3d> pads;
  std::vector<PreparedTarget> targets;
  std::vector<Ring> neighbours;  ///< what else stands within the fence
};

/// In the folder of results.
inline constexpr const char* prepared_name = "prepared.json";
inline constexpr const char* missions_folder = "missions";  ///< a file for each target
inline constexpr const char* flights_folder = "flights";    ///< a file for each pad, and routes

/// "pad_1": of the names of a pad's mission and route files.
std::string pad_name(std::size_t pad);

std::string prepared_json(const Prepared& prepared);

/// Throws Error{bad_file} naming the file unless it is as prepared_json() has it.
Prepared read_prepared(const std::filesystem::path& file);

/// The surveys of the targets that have missions, as a campaign whose missions are in `out`.
CampaignFile campaign_of(const DistrictFile& district, const Prepared& prepared,
                         const std::filesystem::path& out);

/// What is being done, for a progress line.
using Tell = std::function<void(const std::string&)>;

/// Finds the targets and writes into `out` a mission for each, with what stands near it, the
/// mission of the flight of all, and last prepared.json. What is there of the same digest
/// stands as it is. Throws Error{bad_config} or Error{bad_file} in one line.
Prepared prepare(const DistrictFile& district, const std::filesystem::path& out, const Tell& tell);

}  // namespace skycap::missions::batch
