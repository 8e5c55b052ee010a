/// Transformation from file coordinates to the site frame, used for all formats.
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

/// Maximum distance of data from the site [m].
inline constexpr double farthest_from_site = 50'000.0;

class SiteTransform {
 public:
  /// Without `needs_heights`, z is ignored and results have the height of the site's origin.
  /// Without a reference system, coordinates are in the mission frame. Throws Error{bad_config} if
  /// source, file and site do not define the position of the data. Throws all errors of
  /// geodetic_transform().
  SiteTransform(const Source& source, const FileContents& contents, const SiteFrame& site,
                bool needs_heights = true);

  /// Transforms file coordinates to the site frame in place. Throws Error{bad_config} if a result
  /// is more than 50 km from the site or undefined.
  void to_site(std::span<Eigen::Vector3d> coordinates) const;

  /// Transforms file coordinates to WGS84 longitude and latitude in degrees and ellipsoidal height
  /// in metres. Requires a reference system.
  void to_geodetic(std::span<Eigen::Vector3d> coordinates) const;

  /// Returns the lengths of the file's units in east, north and up direction near the data [m].
  Eigen::Vector3d metres_per_unit() const { return metres_per_unit_; }
  const std::string& crs() const { return name_; }
  /// Returns true if the reference system defines the vertical datum.
  bool has_own_heights() const { return geodetic_ && geodetic_->has_own_heights; }
  /// Returns true if the vertical datum is separate from the horizontal system, such as a geoid.
  bool has_vertical_datum() const { return geodetic_ && geodetic_->is_compound; }
  const std::vector<std::string>& notes() const { return notes_; }
  /// Returns the maximum error of substitute operations in the conversion to WGS84 [m].
  double substitution_error() const { return geodetic_ ? geodetic_->substitution_error : 0.0; }

 private:
  void prepare_pose(const Source& source, const FileContents& contents);
  void prepare_crs(const Source& source, const FileContents& contents, const SiteFrame& site);
  void require_unit(const Source& source, const FileContents& contents) const;
  void prepare_units(const Source& source, const FileContents& contents);
  [[noreturn]] void reject(const Eigen::Vector3d& coordinate, const Eigen::Vector3d& pose) const;

  std::filesystem::path file_;
  bool needs_heights_;
  /// Combined transformation by unit, up axis, offset and place.
  Eigen::Affine3d base_transform_ = Eigen::Affine3d::Identity();
  /// Transformation to WGS84. If empty, base_transform_ is the whole transformation.
  std::optional<GeodeticTransform> geodetic_;
  std::optional<flight::GeodeticPoint> origin_;
  std::string name_;
  std::vector<std::string> notes_;
  Eigen::Vector3d metres_per_unit_ = Eigen::Vector3d::Ones();
};

}  // namespace skycap::missions::site_data
