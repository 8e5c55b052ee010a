/// Earlier scans as prior data, larger than memory if need be, thinned while they are read: LAS,
/// compressed (LAZ, COPC) or not, and E57.
#pragma once

#include <functional>
#include <vector>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

struct CloudThinning {
  double spacing = 1.0;  ///< one point a cube of this side is kept [m]
  /// How long the file's units are [m], once its reference system is known.
  std::function<Eigen::Vector3d(const FileContents&)> metres_per_unit;
};

/// The points of those classes, of none named all but noise (7, 18); the reference system is that
/// of the file's records, as WKT or as EPSG numbers of its GeoKeys. Withheld points are passed
/// over. Throws Error{bad_file}.
FileContents read_las(const std::filesystem::path& file, const std::vector<int>& classes,
                      const CloudThinning& thinning);

/// The points of all scans; the reference system is the file's coordinateMetadata. Points that are
/// marked as invalid are passed over. Throws Error{bad_file}.
FileContents read_e57(const std::filesystem::path& file, const CloudThinning& thinning);

}  // namespace skycap::missions::site_data
