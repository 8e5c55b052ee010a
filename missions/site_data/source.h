/// Settings of a file of prior data: maps, city models, terrain, earlier scans. These are the
/// values under `prior` in a mission file (docs/reference/mission-file.md).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/site_data/formats/meanings.h"

namespace skycap::missions::site_data {

/// Role of a file in a survey. No role ever verifies that space is free.
enum class Role {
  target,    ///< Object to survey: defines the initial predicted surface and the reported coverage.
  obstacle,  ///< Obstacle for all legs.
  terrain,   ///< Ground for clearance, take-off and the base of extruded polygons.
  truth,     ///< Replaces `scene.model`.
};

/// Selection from a file. Empty members select everything.
struct Selection {
  std::vector<std::string> ids;  ///< Ids of objects or of their parents.
  /// Attribute values that an object must have, compared as strings.
  std::map<std::string, std::string> attributes;
  std::filesystem::path within;  ///< Polygon file with its own reference system.
  std::vector<int> classes;      ///< ASPRS classes of a cloud's points.
  std::string layer;             ///< Layer of a file with several layers.
  std::optional<double> lod;     ///< Level of detail (default: the highest of each object).
};

/// Default spacing of downsampled clouds [m]: a quarter of the minimum clearance of vehicles, like
/// voxels.
inline constexpr double usual_spacing = 0.25;

/// Position of a file without a coordinate reference system in the site frame.
struct SourcePose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Position of the file's origin [m].
  double heading = 0.0;  ///< Heading of the file's y axis, clockwise from north [rad].
};

/// Prior data file with its settings. File coordinates are multiplied by `unit`, rotated upright by
/// `up_axis`, and shifted by `offset`. Then `pose` or the reference system converts them to the
/// site frame; without either, they are in that frame. For maps, `unit` applies only to heights.
struct Source {
  std::filesystem::path file;  ///< Absolute path, or path relative to the working directory.
  Role role = Role::obstacle;
  Selection select;
  std::string crs;  ///< Reference system, in any form that PROJ supports (default: from the file).
  std::optional<HeightDatum> vertical;  ///< Vertical datum (default: that of the reference system).
  std::optional<SourcePose> pose;       ///< Position in the site frame; conflicts with crs.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::optional<double> unit;    ///< Length of the unit [m] (default: from the file, otherwise 1).
  std::optional<bool> is_y_up;   ///< The y axis points up (default: from the file, otherwise z).
  bool base_on_terrain = false;  ///< Place extruded polygons on the terrain at their lowest corner.
  /// Alternative height of the base in the vertical datum of the file.
  std::optional<double> base;
  std::optional<double> height;  ///< Height of extruded polygons above their base [m].
  std::string height_attribute;  ///< Name of the height attribute of a map (default: known names).
  double min_height = 0.0;       ///< Height of the lower end above the base [m].
  std::optional<double> uncertainty;  ///< Maximum error of the surfaces [m]; see prior.h.
  /// Cube size for downsampling clouds (default: usual_spacing) [m].
  std::optional<double> spacing;
};

}  // namespace skycap::missions::site_data
