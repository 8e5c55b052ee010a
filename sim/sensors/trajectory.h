/// Trajectory of a moving platform, and simulation of the trajectory estimated by its navigation.
///
/// Body frame: x forward, y left, z up.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "sim/sensors/navigation_errors.h"

namespace skycap::sim {

struct StampedPose {
  double time = 0.0;                                             ///< Time [s].
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< World frame [m].
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< world_from_body.
};

/// Time-stamped poses with interpolation: linear for positions, slerp along the shorter great
/// circle for attitudes. Immutable and thread-safe.
class Trajectory {
 public:
  /// Normalises the attitudes. Throws Error{bad_geometry} if there are no poses. Otherwise it names
  /// the first pose that is not finite, has a zero attitude, or is not later than the previous one.
  explicit Trajectory(std::vector<StampedPose> poses);

  double start() const { return poses_.front().time; }
  double end() const { return poses_.back().time; }
  std::span<const StampedPose> poses() const { return poses_; }

  /// Returns world_from_body at `time` [s]. Before the start and after the end, the platform is
  /// stationary.
  Eigen::Isometry3d pose(double time) const;

 private:
  std::vector<StampedPose> poses_;
};

/// Returns the trajectory that the navigation of a platform on trajectory `ground_truth` estimates,
/// at the same times. Position errors are in world axes, attitude errors are small rotations around
/// body axes.
Trajectory estimated_trajectory(const Trajectory& ground_truth, const NavigationErrors& errors);

}  // namespace skycap::sim
