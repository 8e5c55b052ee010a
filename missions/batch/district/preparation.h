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
struct DistrictTarget {
  std::string title;             ///< title of its mission
  std::vector<std::string> ids;  ///< identifiers in the map
  std::vector<Ring> outlines;
  Eigen::AlignedBox3d box;                        ///< bounding box of all objects
  Eigen::AlignedBox3d unknown;                    ///< box in which unobserved space is occupied
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();  ///< take-off point of its survey
  std::string rejection_reason;  ///< reason why it has no mission; empty if it has one
};

struct DistrictPlan {
  std::string content_checksum;  ///< checksum of the district file and all files it names
  std::vector<Eigen::Vector3d> pads;
  std::vector<DistrictTarget> targets;
  std::vector<Ring> neighbours;  ///< outlines of other objects within the geofence
};

/// File name in the results folder.
inline constexpr const char* district_plan_name = "prepared.json";
inline constexpr const char* missions_folder = "missions";  ///< folder with one file per target
/// Folder with one file per pad, and routes.
inline constexpr const char* flights_folder = "flights";

/// Returns the stem of a pad's mission and route files, such as "pad_1".
std::string pad_name(std::size_t pad);

std::string district_plan_json(const DistrictPlan& district_plan);

/// Reads a file written by district_plan_json(). Throws Error{bad_file} with the file name if it is
/// invalid.
DistrictPlan read_district_plan(const std::filesystem::path& file);

/// Returns the campaign that surveys all targets with a mission. The missions are in `out`.
CampaignFile make_campaign(const DistrictFile& district, const DistrictPlan& district_plan,
                           const std::filesystem::path& out);

/// Callback for progress messages.
using ReportProgress = std::function<void(const std::string&)>;

/// Finds the targets and writes a mission with nearby objects for each into `out`. It also writes
/// the mission of the joint flight and, last, prepared.json. Existing output with the same checksum
/// is reused. Throws Error{bad_config} or Error{bad_file} with a one-line message.
DistrictPlan prepare(const DistrictFile& district, const std::filesystem::path& out,
                     const ReportProgress& report_progress);

}  // namespace skycap::missions::batch
