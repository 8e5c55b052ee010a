/// How near a long path of short steps comes to anything.
#pragma once

#include <Eigen/Core>

#include "flight/space/clearance.h"

namespace skycap::flight {

/// Distances change by no more than the vehicle moves, so only steps are asked for that may be
/// nearer than all before: the least distance is exact all the same. Keeps a reference.
class NearestPass {
 public:
  /// Nothing farther than `up_to` is of interest.
  NearestPass(const FreeSpace& space, double up_to) : space_(space) { nearest_.distance = up_to; }

  /// Goes one step further. Whether it is the nearest so far.
  bool pass(const Segment& step);

  const Closest& nearest() const { return nearest_; }

 private:
  const FreeSpace& space_;
  Closest nearest_{};
  Eigen::Vector3d known_at_ = Eigen::Vector3d::Zero();
  double known_free_ = -1.0;  ///< around `known_at_`; negative: nothing is known
};

}  // namespace skycap::flight
