/// How far a scan saw in every direction: whoever stands in front of that was seen through.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/scan.h"

namespace skycap::missions::online {

enum class Sight {
  unknown,  ///< the scan has too few returns there
  hidden,   ///< behind what the scan measured
  there,    ///< where the scan measured something
  through,  ///< the scan measured farther: nothing was there
};

/// Ranges by direction: the six faces of a cube about the sensor, in cells of about a degree. A
/// cell speaks for itself only together with the eight around it, so that edges are nobody's.
class RangeImage {
 public:
  /// Of some hundred thousand points, spread evenly over the scan.
  explicit RangeImage(const geometry::ScanSpan& scan);

  /// What the scan says of a point in the world frame, measured to `tolerance` [m].
  Sight sight(const Eigen::Vector3d& point, double tolerance) const;

 private:
  struct Cell {
    float nearest, farthest;  ///< of the nine cells; nearest above farthest: unknown
  };
  Eigen::Vector3d sensor_;
  std::vector<Cell> cells_;
};

}  // namespace skycap::missions::online
