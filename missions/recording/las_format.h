/// Point clouds in LAS 1.4 (ASPRS specification R15), point formats 6 and 7.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "flight/export/utm.h"
#include "missions/recording/cloud_file.h"

namespace skycap::missions::recording {

struct LasConfig {
  int point_format = 6;                              ///< 7 has a colour too: the intensity as grey
  double scale = 1e-4;                               ///< coordinates are multiples of it [m]
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< near the points as written: 32 bits each
  /// Puts points of the mission's frame on the map; without it they stay local.
  std::shared_ptr<const flight::UtmProjection> projection;
  /// The coordinate reference system as OGC WKT; local east-north-up by default.
  std::string crs_wkt =
      "LOCAL_CS[\"local east-north-up\",LOCAL_DATUM[\"mission origin\",0],UNIT[\"metre\",1],"
      "AXIS[\"east\",EAST],AXIS[\"north\",NORTH],AXIS[\"up\",UP]]";

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// Intensity is scaled so that a white surface faced squarely has 65535; the channel modulo 256 is
/// the user data; GPS time is the shot's. Throws what LasConfig::validate() throws.
std::shared_ptr<const CloudFormat> las_format(const LasConfig& config);

}  // namespace skycap::missions::recording
