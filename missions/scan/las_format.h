/// Settings of LAS 1.4 files (ASPRS specification R15) with point formats 6 and 7, also compressed
/// (LAZ).
#pragma once

#include <memory>

#include "missions/scan/cloud_file.h"
#include "missions/scan/coordinate_grid.h"

namespace skycap::missions::scan {

struct LasConfig {
  int point_format = 6;        ///< Format 7 adds a colour: the intensity as grey.
  bool is_compressed = false;  ///< LAZ, with a chunk for each piece of the scan.
  CoordinateGrid grid = {};

  /// Throws Error{bad_config} naming the first field outside its valid interval.
  void validate() const;
};

/// Returns the LAS format. A white surface at normal incidence has the intensity 65535. User data
/// contains the channel modulo 256, and GPS time is that of the pulse. Throws all errors of
/// LasConfig::validate().
std::shared_ptr<const CloudFormat> las_format(const LasConfig& config);

}  // namespace skycap::missions::scan
