/// Visibility of a point relative to the ranges of a scan.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/scan.h"

namespace skycap::missions::online {

enum class Visibility {
  unknown,  ///< The scan has too few returns in this direction.
  hidden,   ///< The point is behind the measured surface.
  there,    ///< The point is on the measured surface.
  through,  ///< The scan measured a longer range, so the point is in free space.
};

/// Ranges by direction: the six faces of a cube around the sensor, in cells of about one degree. A
/// cell is evaluated together with its eight neighbours, so that results at edges are `unknown`.
class RangeImage {
 public:
  /// Uses up to some hundred thousand points, evenly distributed over the scan.
  explicit RangeImage(const geometry::ScanSpan& scan);

  /// Returns the visibility of a point in the world frame. `tolerance` is the range error [m].
  Visibility visibility(const Eigen::Vector3d& point, double tolerance) const;

 private:
  struct Cell {
    /// Min and max of the nine cells. Unknown if `nearest` exceeds `farthest`.
    float nearest, farthest;
  };
  Eigen::Vector3d sensor_;
  std::vector<Cell> cells_;
};

}  // namespace skycap::missions::online
