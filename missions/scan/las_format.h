/// Point clouds in LAS 1.4 (ASPRS specification R15), point formats 6 and 7.
#pragma once

#include <memory>

#include "missions/scan/cloud_file.h"
#include "missions/scan/coordinate_grid.h"

namespace skycap::missions::scan {

struct LasConfig {
  int point_format = 6;  ///< 7 has a colour too: the intensity as grey
  CoordinateGrid grid = {};

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// Intensity is scaled so that a white surface faced squarely has 65535; the channel modulo 256 is
/// the user data; GPS time is the shot's. Throws what LasConfig::validate() throws.
std::shared_ptr<const CloudFormat> las_format(const LasConfig& config);

}  // namespace skycap::missions::scan
