/// Mission files with a word on each value.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "missions/site_data/source.h"

namespace skycap::missions::wizard {

/// What a first mission says; places in its frame, in metres.
struct MissionValues {
  std::filesystem::path file;        ///< that the text is for: it names others as from its folder
  std::string verb = "skycap site";  ///< that proposes it
  std::string vehicle;
  std::vector<site_data::Source> sources;
  flight::GeodeticPoint origin;
  std::string origin_is = "the centre of the target, at its lowest point";
  double ground = 0.0;           ///< z of the ground where the sources have none
  bool sees_neighbours = false;  ///< of the sources in the dry run
  Eigen::AlignedBox3d unknown;   ///< where nothing is free before it is measured
  std::vector<Eigen::AlignedBox3d> unknown_beside{};  ///< likewise, of neighbours
  Eigen::AlignedBox3d fence{};
  std::optional<Eigen::AlignedBox3d> scene{};  ///< whose surface is wanted; none in a draft
  std::optional<Eigen::Vector3d> pad{};        ///< likewise
  double clearance = 0.0, registration_distance = 0.0, view_distance = 0.0;
};

/// How far the sensor measures that the mission proposes [m].
double sensor_range(const MissionValues& values);

std::string mission_text(const MissionValues& values);

}  // namespace skycap::missions::wizard
