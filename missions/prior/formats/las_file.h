/// LAS files, compressed (LAZ, COPC) or not, as prior data: larger than memory if need be, thinned
/// while they are read.
#pragma once

#include <functional>
#include <vector>

#include "missions/prior/formats/file_contents.h"

namespace skycap::missions::prior {

struct LasThinning {
  std::vector<int> classes;  ///< that are read; empty: all but noise (7, 18)
  double spacing = 1.0;      ///< one point a cube of this side is kept [m]
  /// How long the file's units are [m], once its reference system is known.
  std::function<Eigen::Vector3d(const FileContents&)> metres_per_unit;
};

/// The points; the reference system is that of the file's records, as WKT or as EPSG numbers of
/// its GeoKeys. Withheld points are passed over. Throws Error{bad_file}.
FileContents read_las(const std::filesystem::path& file, const LasThinning& thinning);

}  // namespace skycap::missions::prior
