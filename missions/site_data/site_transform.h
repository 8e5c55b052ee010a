/// From the coordinates of a file to the site's frame: the one way in for all formats.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/reference_system.h"

namespace skycap::missions::site_data {

/// Farther from the site nothing is taken to be meant [m].
inline constexpr double farthest_from_site = 50'000.0;

class SiteTransform {
 public:
  /// Without `needs_heights` z is not looked at, and places come out at the height of the site's
  /// origin. What names no reference system is in the mission's frame. Throws Error{bad_config} if
  /// source, file and site together do not say where things are; what geodetic_transform() throws.
  SiteTransform(const Source& source, const FileContents& contents, const SiteFrame& site,
                bool needs_heights = true);

  /// Moves coordinates of the file to the site's frame. Throws Error{bad_config} if one is farther
  /// than 50 km from the site or has no image.
  void to_site(std::span<Eigen::Vector3d> coordinates) const;

  /// The same as far as WGS84: longitude and latitude in degrees, ellipsoid height. Only of files
  /// with a reference system.
  void to_geodetic(std::span<Eigen::Vector3d> coordinates) const;

  /// How long units of the file are, east, north and up, near a coordinate.
  Eigen::Vector3d metres_per_unit() const { return metres_per_unit_; }
  const std::string& crs() const { return name_; }
  /// Whether the reference system says what heights count from.
  bool has_own_heights() const { return geodetic_ && geodetic_->has_own_heights; }
  /// Whether that is a datum beside the map's, as a geoid is.
  bool has_vertical_datum() const { return geodetic_ && geodetic_->is_compound; }
  const std::vector<std::string>& notes() const { return notes_; }
  /// What stand-ins on the way to WGS84 may be off [m].
  double stand_in_error() const { return geodetic_ ? geodetic_->stand_in_error : 0.0; }

 private:
  void prepare_place(const Source& source, const FileContents& contents);
  void prepare_crs(const Source& source, const FileContents& contents, const SiteFrame& site);
  void require_unit(const Source& source, const FileContents& contents) const;
  void prepare_units(const Source& source, const FileContents& contents);
  [[noreturn]] void refuse(const Eigen::Vector3d& coordinate, const Eigen::Vector3d& place) const;

  std::filesystem::path file_;
  bool needs_heights_;
  Eigen::Affine3d prepared_ = Eigen::Affine3d::Identity();  ///< unit, up axis, offset, place
  std::optional<GeodeticTransform> geodetic_;               ///< without: prepared_ does it all
  std::optional<flight::GeodeticPoint> origin_;
  std::string name_;
  std::vector<std::string> notes_;
  Eigen::Vector3d metres_per_unit_ = Eigen::Vector3d::Ones();
};

}  // namespace skycap::missions::site_data
