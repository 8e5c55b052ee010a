/// Minimum distance of a long path of short steps from obstacles.
#pragma once

#include <Eigen/Core>

#include "flight/clearance/clearance.h"

namespace skycap::flight {

/// Exact minimum distance with few queries. Since a distance changes by no more than the vehicle
/// moves, only steps that may undercut the minimum are evaluated. Keeps a reference to the space.
class NearestPass {
 public:
  /// Distances above `up_to` [m] are ignored.
  NearestPass(const FreeSpace& space, double up_to) : space_(space) { nearest_.distance = up_to; }

  /// Processes the next step. Returns true if it is the closest so far.
  bool pass(const Segment& step);

  const Closest& nearest() const { return nearest_; }

 private:
  const FreeSpace& space_;
  Closest nearest_{};
  Eigen::Vector3d known_at_ = Eigen::Vector3d::Zero();
  double known_free_ = -1.0;  ///< Free radius around `known_at_` [m]. Negative: unknown.
};

}  // namespace skycap::flight
