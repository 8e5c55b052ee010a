/// Readers of point clouds as prior data: LAS, compressed (LAZ, COPC) or not, and E57. Files may be
/// larger than memory, because points are downsampled while reading.
#pragma once

#include <functional>
#include <vector>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

struct CloudDownsampling {
  double spacing = 1.0;  ///< Side of the cubes of which one point each is kept [m].
  /// Returns the length of the file's units [m]. Called when the reference system is known.
  std::function<Eigen::Vector3d(const FileContents&)> metres_per_unit;
};

/// Reads the points of the given classes, or all points except noise (7, 18) if `classes` is empty.
/// The reference system is taken from the file's records, as WKT or as EPSG numbers of the GeoKeys.
/// Withheld points are skipped. Throws Error{bad_file}.
FileContents read_las(const std::filesystem::path& file, const std::vector<int>& classes,
                      const CloudDownsampling& downsampling);

/// Reads the points of all scans. The reference system is the file's coordinateMetadata. Points
/// marked as invalid are skipped. Throws Error{bad_file}.
FileContents read_e57(const std::filesystem::path& file, const CloudDownsampling& downsampling);

}  // namespace skycap::missions::site_data
