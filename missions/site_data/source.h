/// What a mission file says of one file of prior data: maps, city models, terrain, earlier scans.
/// Plain data under `prior`; docs/reference/mission-file.md lists the keys.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/site_data/formats/meanings.h"

namespace skycap::missions::site_data {

/// What a file is to a survey. None of them ever proves that space is free.
enum class Role {
  target,    ///< is surveyed: the planner's first guesses, and what coverage is told of
  obstacle,  ///< is in the way of every leg
  terrain,   ///< the ground: clearance over it, take-off, the base of extruded polygons
  truth,     ///< stands in for `scene.model`
};

/// What of a file is meant; what is empty selects everything.
struct Selection {
  std::vector<std::string> ids;                   ///< of objects, or of objects they are part of
  std::map<std::string, std::string> attributes;  ///< all must be equal, as text
  std::filesystem::path within;                   ///< a file of polygons, in its own coordinates
  std::vector<int> classes;                       ///< ASPRS classes of a cloud's points
  std::string layer;                              ///< of a file with several
  std::optional<double> lod;                      ///< level of detail; else each object's highest
};

/// Clouds are thinned to it where nothing is said: a quarter of the clearance that vehicles keep at
/// least, as voxels are [m].
inline constexpr double usual_spacing = 0.25;

/// Where a file without a coordinate reference system is in the site's frame.
struct Place {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the file's origin
  double heading = 0.0;  ///< of the file's y axis, clockwise from north [rad]
};

/// In this order a coordinate of the file is multiplied by `unit`, turned upright by `up_axis`,
/// moved by `offset`, and brought into the site's frame by `place` or by the reference system;
/// without either it is in that frame. On maps `unit` is of heights alone.
struct Source {
  std::filesystem::path file;  ///< absolute, or as from the running program
  Role role = Role::obstacle;
  Selection select;
  std::string crs;                      ///< anything PROJ knows; empty: the file's
  std::optional<HeightDatum> vertical;  ///< else the reference system's
  std::optional<Place> place;           ///< excludes crs
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::optional<double> unit;         ///< metres; else the file's, else 1
  std::optional<bool> is_y_up;        ///< else as the file says, else z is
  bool base_on_terrain = false;       ///< of extruded polygons: where the lowest corner stands
  std::optional<double> base;         ///< or this height, in the file's vertical datum
  std::optional<double> height;       ///< of extruded polygons above their base
  std::string height_attribute;       ///< of maps: the one that is it; empty: those that are known
  double min_height = 0.0;            ///< they begin so far above their base
  std::optional<double> uncertainty;  ///< bound of what the file's surfaces may be off; see prior.h
  std::optional<double> spacing;      ///< else usual_spacing: clouds keep one point a cube of it
};

}  // namespace skycap::missions::site_data
