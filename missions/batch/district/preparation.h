/// Creates a mission for each target of a district, and the data required for the joint flight. The
/// results are written once for all tasks.
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

/// Objects that are surveyed together.
struct PreparedTarget {
  std::string title;             ///< title of its mission
  std::vector<std::string> ids;  ///< identifiers in the map
  std::vector<Ring> outlines;
  Eigen::AlignedBox3d box;                        ///< bounding box of all objects
  Eigen::AlignedBox3d unknown;                    ///< box in which unobserved space is occupied
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();  ///< take-off point of its survey
  std::string refusal;  ///< reason why it has no mission; empty if it has one
};

struct Prepared {
  std::string digest;  ///< checksum of the district file and all files it names
  std::vector<Eigen::Vector3d> pads;
  std::vector<PreparedTarget> targets;
  std::vector<Ring> neighbours;  ///< outlines of other objects within the geofence
};

/// File name in the results folder.
inline constexpr const char* prepared_name = "prepared.json";
inline constexpr const char* missions_folder = "missions";  ///< folder with one file per target
/// Folder with one file per pad, and routes.
inline constexpr const char* flights_folder = "flights";

/// Returns the stem of a pad's mission and route files, such as "pad_1".
std::string pad_name(std::size_t pad);

std::string prepared_json(const Prepared& prepared);

/// Reads a file written by prepared_json(). Throws Error{bad_file} with the file name if it is
/// invalid.
Prepared read_prepared(const std::filesystem::path& file);

/// Returns the campaign that surveys all targets with a mission. The missions are in `out`.
CampaignFile campaign_of(const DistrictFile& district, const Prepared& prepared,
                         const std::filesystem::path& out);

/// Callback for progress messages.
using Tell = std::function<void(const std::string&)>;

/// Finds the targets and writes a mission with nearby objects for each into `out`. It also writes
/// the mission of the joint flight and, last, prepared.json. Existing output with the same checksum
/// is reused. Throws Error{bad_config} or Error{bad_file} with a one-line message.
Prepared prepare(const DistrictFile& district, const std::filesystem::path& out, const Tell& tell);

}  // namespace skycap::missions::batch
