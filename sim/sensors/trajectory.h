/// Where a moving platform is at every moment, and how a trajectory that was estimated in flight
/// differs from the one that was flown.
///
/// Body frame: x forward, y left, z up.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "sim/sensors/navigation_errors.h"

namespace skycap::sim {

struct StampedPose {
  double time = 0.0;                                             ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< world frame
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< world_from_body
};

/// Poses in time, interpolated between: positions linearly, attitudes along the shorter great
/// circle at constant rate (slerp). Immutable; safe to use from any number of threads.
class Trajectory {
 public:
  /// Attitudes are normalised. Throws Error{bad_geometry} naming the first pose that is not finite,
  /// has an attitude of length zero, or is not later than the one before; also when there is none.
  explicit Trajectory(std::vector<StampedPose> poses);

  double start() const { return poses_.front().time; }
  double end() const { return poses_.back().time; }
  std::span<const StampedPose> poses() const { return poses_; }

  /// world_from_body at `time`; before the start and after the end the platform stands still.
  Eigen::Isometry3d pose(double time) const;

 private:
  std::vector<StampedPose> poses_;
};

/// The trajectory that the navigation of a platform flying `flown` believes in, at the same times:
/// positions with errors in world axes, attitudes turned by small angles about body axes.
Trajectory believed_trajectory(const Trajectory& flown, const NavigationErrors& errors);

}  // namespace skycap::sim
