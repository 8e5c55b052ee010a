/// Writes mission files with a comment on each value.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "missions/site_data/source.h"
#include "missions/wizard/photo_proposal.h"

namespace skycap::missions::wizard {

/// Values of a proposed mission. Coordinates are in the mission frame [m].
struct MissionValues {
  /// Path of the mission file; other files are written relative to its folder.
  std::filesystem::path file;
  std::string command = "skycap site";  ///< command that creates the proposal
  std::string vehicle;
  std::vector<site_data::Source> sources;
  flight::GeodeticPoint origin;
  std::string origin_is = "the base centre of the target";
  double ground = 0.0;           ///< z of the ground if the sources contain none [m]
  bool sees_neighbours = false;  ///< whether the dry run simulates measurements of other sources
  Eigen::AlignedBox3d unknown;   ///< box in which unobserved space is occupied
  std::vector<Eigen::AlignedBox3d> extra_unknown_boxes{};  ///< further such boxes around neighbours
  Eigen::AlignedBox3d fence{};
  std::optional<Eigen::AlignedBox3d> scene{};  ///< box of the surface to survey; empty in a draft
  std::optional<Eigen::Vector3d> pad{};        ///< take-off point; empty in a draft
  double clearance = 0.0, registration_distance = 0.0, view_distance = 0.0;
  std::string sensor{};  ///< preset, or file of a LiDAR; empty: a depth camera of 320 x 240 pixels
  std::optional<double> max_range{};   ///< depth to plan with [m]; none: sensor_range()
  std::optional<PhotoValues> photo{};  ///< Values of a photo mission instead of `sensor`.
};

/// Returns the maximum range of the proposed sensor [m].
double sensor_range(const MissionValues& values);

/// True if a preset or sensor file describes a LiDAR, false for cameras. Throws what
/// config::find_sensor() throws.
bool is_lidar(const std::string& sensor);

std::string mission_text(const MissionValues& values);

}  // namespace skycap::missions::wizard
