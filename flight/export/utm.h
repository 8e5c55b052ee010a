/// Projection from the local frame to Universal Transverse Mercator, the usual system of surveyed
/// point clouds.
#pragma once

#include <string>

#include <Eigen/Core>

#include "flight/export/geodesy.h"

namespace skycap::flight {

/// UTM on WGS84 in the zone of the site's origin. If the site's geoid undulation is known, it
/// applies to the whole site and heights are above EGM96. Otherwise they are above the ellipsoid.
/// Immutable and thread-safe.
class UtmProjection {
 public:
  /// Throws Error{bad_config} if the site is invalid or beyond the latitude limits of UTM.
  explicit UtmProjection(const Site& site);

  int zone() const { return zone_; }
  int epsg() const { return (is_north_ ? 32600 : 32700) + zone_; }

  /// Returns easting, northing and height of a local point [m]. Within 1 km of the origin, a
  /// second-order series is used, with an error below 0.01 mm. Beyond, the error is below 10 nm.
  Eigen::Vector3d to_map(const Eigen::Vector3d& local) const;

  /// Returns the result of to_map() without the series, at any distance.
  Eigen::Vector3d to_map_exactly(const Eigen::Vector3d& local) const;

  /// Returns the coordinate reference system including heights as OGC WKT 1 with EPSG codes.
  std::string wkt() const;

 private:
  bool is_above_geoid_ = false;
  double undulation_ = 0.0;
  int zone_ = 0;
  bool is_north_ = true;
  LocalFrame frame_;
  // Taylor coefficients at the origin: value, gradient, and second derivatives (xx, yy, zz, yz, xz,
  // xy).
  Eigen::Vector3d at_origin_;
  Eigen::Matrix3d slopes_;
  Eigen::Matrix<double, 3, 6> curvature_;
};

}  // namespace skycap::flight
