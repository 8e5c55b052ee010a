/// From the local frame to the Universal Transverse Mercator projection, in which surveyors keep
/// their clouds.
#pragma once

#include <string>

#include <Eigen/Core>

#include "flight/export/geodesy.h"

namespace skycap::flight {

/// UTM on WGS84, in the zone of a site's origin. Heights are above the EGM96 geoid if the site's
/// undulation is known, which then holds for all of the site, and above the ellipsoid otherwise.
/// Immutable; safe to use from any number of threads.
class UtmProjection {
 public:
  /// Throws Error{bad_config} if the site is not valid, or nearer to a pole than UTM goes.
  explicit UtmProjection(const Site& site);

  int zone() const { return zone_; }
  int epsg() const { return (is_north_ ? 32600 : 32700) + zone_; }

  /// Easting, northing and height of a point of the local frame. Within a kilometre of its origin
  /// by a series of second order, which is off by less than 0.01 mm; exact to 10 nm beyond.
  Eigen::Vector3d to_map(const Eigen::Vector3d& local) const;

  /// The same at any distance without the series.
  Eigen::Vector3d to_map_exactly(const Eigen::Vector3d& local) const;

  /// The coordinate system, heights included, as OGC WKT 1, with the EPSG's codes.
  std::string wkt() const;

 private:
  bool is_above_geoid_ = false;
  double undulation_ = 0.0;
  int zone_ = 0;
  bool is_north_ = true;
  LocalFrame frame_;
  // About the origin: value, slopes, and second derivatives (xx, yy, zz, yz, xz, xy).
  Eigen::Vector3d at_origin_;
  Eigen::Matrix3d slopes_;
  Eigen::Matrix<double, 3, 6> curvature_;
};

}  // namespace skycap::flight
