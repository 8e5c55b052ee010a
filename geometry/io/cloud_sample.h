/// Reads a part of a point cloud that is large enough to display it.
#pragma once

#include <cstddef>
#include <filesystem>

#include <Eigen/Core>

#include "geometry/io/cloud_io.h"

namespace skycap::geometry {

/// Points of a file and their number before sampling.
struct CloudSample {
  AttributedCloud cloud;
  std::size_t of = 0;
  /// Position in the file minus that in `cloud` [m]: whole kilometres. Zero unless the file's
  /// coordinates are too large for single precision.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// Reads about `max_points` points of a LAS or LAZ file, and all of a smaller one. A sample
/// consists of short sequences of consecutive points, evenly distributed over the file; the other
/// points are neither read nor decoded. Throws Error{bad_file}, also for a file without points.
CloudSample sample_las_cloud(const std::filesystem::path& path, std::size_t max_points);

}  // namespace skycap::geometry
