/// From a file's coordinate reference system to WGS84 by PROJ, which is loaded when it is needed.
/// No network, no ballpark: the best operation that PROJ knows for the site, or a refusal.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "missions/site_data/source.h"

namespace skycap::missions::site_data {

struct ReferenceRequest {
  std::string crs;                      ///< anything PROJ parses
  bool is_latitude_first = false;       ///< of a geographic system; else x is east, always
  std::optional<HeightDatum> vertical;  ///< in place of the system's own heights
  std::optional<HeightDatum> vertical_if_silent;  ///< where the system has no heights
  bool needs_heights = true;                      ///< else z means nothing
  std::optional<flight::GeodeticPoint> near;      ///< the site: operations are chosen for it
  std::optional<double> takeoff_height;           ///< of the pad above the ellipsoid
};

/// A way from a file's coordinates to latitude, longitude and height.
struct GeodeticTransform {
  std::string name;                ///< of the reference system
  double horizontal_unit = 1.0;    ///< metres; 1 for degrees
  bool is_geographic = false;      ///< x and y are degrees
  bool has_own_heights = false;    ///< it is compound or three-dimensional
  bool is_compound = false;        ///< of a map and a datum of heights
  double height_unit = 1.0;        ///< metres; 1 without heights of its own
  std::vector<std::string> notes;  ///< what stands in for what, with the accuracy PROJ states
  double stand_in_error = 0.0;     ///< what all of those together may be off [m]
  /// Replaces (x, y, z) by (longitude, latitude, ellipsoid height), in degrees and metres. What has
  /// no image becomes infinite. One thread at a time.
  std::function<void(std::span<Eigen::Vector3d>)> apply;
};

/// On the map the next best operation that PROJ has grids for stands in for the best one if it is
/// within 5 m; for heights EGM96 does where `vertical` is geoid. Throws Error{bad_config} if PROJ
/// does not know the system, if heights are needed and neither the system nor `vertical` says what
/// they count from, if they count from a pad that is not known, or if nothing may stand in for the
/// best operation; Error{bad_file} if PROJ is not installed.
GeodeticTransform geodetic_transform(const ReferenceRequest& request);

/// A name that authorities' files use in place of one that PROJ knows, translated; others as they
/// are. "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH" is EPSG:25832+7837, and so its siblings, with
/// blanks or the name of a geoid behind.
std::string proj_name(const std::string& crs);

/// By the numbers of the EPSG in a name that PROJ does not know, such as
/// "urn:ogc:def:crs:EPSG:2056, crs:EPSG:5728" of swisstopo: a system, or a map and heights. Empty
/// if there are none, or more than two.
std::string name_by_numbers(const std::string& crs);

/// What a name that is not understood may mean, as a remedy; empty: nothing is known of it.
std::string likely_name(const std::string& crs);

}  // namespace skycap::missions::site_data
