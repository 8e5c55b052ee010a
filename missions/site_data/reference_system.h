/// Conversion from a file's coordinate reference system to WGS84 by PROJ, which is loaded on
/// demand. Network access and ballpark transformations are disabled. Either the best operation
/// known to PROJ for the site is used, or an error is thrown.
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
  std::string crs;  ///< Any definition that PROJ can parse.
  /// The axis order of a geographic system is latitude, longitude; otherwise x is always east.
  bool is_latitude_first = false;
  std::optional<HeightDatum> vertical;            ///< Replaces the vertical datum of the system.
  std::optional<HeightDatum> vertical_if_silent;  ///< Vertical datum if the system has none.
  bool needs_heights = true;                      ///< Heights are required; otherwise z is ignored.
  /// Position of the site, for the selection of operations.
  std::optional<flight::GeodeticPoint> near;
  std::optional<double> takeoff_height;  ///< Ellipsoidal height of the pad [m].
};

/// Transformation from file coordinates to latitude, longitude and height.
struct GeodeticTransform {
  std::string name;              ///< Name of the reference system.
  double horizontal_unit = 1.0;  ///< Horizontal unit in metres; 1 for degrees.
  bool is_geographic = false;    ///< x and y are in degrees.
  bool has_own_heights = false;  ///< The system is compound or three-dimensional.
  bool is_compound = false;  ///< The system consists of a horizontal system and a vertical datum.
  double height_unit = 1.0;  ///< Unit of heights in metres; 1 without own heights.
  /// Substitute operations with their accuracies as stated by PROJ.
  std::vector<std::string> notes;
  double substitution_error = 0.0;  ///< Sum of the accuracies of the substitute operations [m].
  /// Replaces (x, y, z) by longitude and latitude in degrees and ellipsoidal height in metres.
  /// Points that cannot be transformed become infinite. Not thread-safe.
  std::function<void(std::span<Eigen::Vector3d>)> apply;
};

/// Finds the transformation to WGS84. The next best horizontal operation with available grids is
/// used instead of the best one if its accuracy is within 5 m. For heights, EGM96 is the substitute
/// if `vertical` is geoid. Throws Error{bad_file} if PROJ is not installed. Throws
/// Error{bad_config} for unknown systems, for heights without a vertical datum, for heights above
/// an unknown pad, or if no operation is accurate enough.
GeodeticTransform geodetic_transform(const ReferenceRequest& request);

/// Translates names used by authorities to names known to PROJ. For example,
/// "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH" becomes EPSG:25832+7837. Spaces or the name of a geoid
/// may follow. "CH1903" is the map projection of that name, EPSG:21781. Other names are returned
/// unchanged.
std::string proj_name(const std::string& crs);

/// Returns a name built from the EPSG numbers in a name that PROJ does not know, such as
/// swisstopo's "urn:ogc:def:crs:EPSG:2056, crs:EPSG:5728". The numbers are those of one system, or
/// of a horizontal and a vertical system. Returns an empty string without numbers or with more than
/// two.
std::string name_by_numbers(const std::string& crs);

/// Returns a suggestion for the meaning of an unknown name, as a remedy in messages. Empty without
/// a suggestion.
std::string likely_name(const std::string& crs);

}  // namespace skycap::missions::site_data
