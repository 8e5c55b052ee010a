#include "sim/sensors/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "geometry/error.h"
#include "geometry/pose/world.h"
#include "sim/sensors/navigation_errors.h"

namespace skycap::sim {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

void require_pose(bool holds, std::size_t pose, const std::string& what) {
  if (holds) return;
  throw Error(ErrorKind::bad_geometry, "trajectory pose " + std::to_string(pose) + " " + what);
}

}  // namespace

Trajectory::Trajectory(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  if (poses_.empty()) throw Error(ErrorKind::bad_geometry, "the trajectory has no poses");
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    StampedPose& pose = poses_[i];
    require_pose(std::isfinite(pose.time) && pose.attitude.coeffs().allFinite(), i,
                 "has a non-finite value");
    geometry::require_valid_position(pose.position, "trajectory pose " + std::to_string(i));
    require_pose(pose.attitude.norm() > 1e-6, i, "has an attitude quaternion of zero length");
    require_pose(i == 0 || pose.time > poses_[i - 1].time, i,
                 "must be later than the previous pose");
    pose.attitude.normalize();
  }
}

Eigen::Isometry3d Trajectory::pose(double time) const {
  const auto next =
      std::upper_bound(poses_.begin(), poses_.end(), time,
                       [](double moment, const StampedPose& pose) { return moment < pose.time; });
  StampedPose at = next == poses_.begin() ? poses_.front() : *(next - 1);
  if (next != poses_.begin() && next != poses_.end()) {
    const double share = (time - at.time) / (next->time - at.time);
    at.position += share * (next->position - at.position);
    at.attitude = at.attitude.slerp(share, next->attitude);
  }
  return Eigen::Translation3d(at.position) * at.attitude;
}

Trajectory estimated_trajectory(const Trajectory& ground_truth, const NavigationErrors& errors) {
  NavigationProcess process(errors);
  std::vector<StampedPose> poses(ground_truth.poses().begin(), ground_truth.poses().end());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::array<double, 6> error = process.next(
        i == 0 ? 0.0 : ground_truth.poses()[i].time - ground_truth.poses()[i - 1].time);
    for (int axis = 0; axis < 3; ++axis) {
      poses[i].position[axis] += error[axis];
      poses[i].attitude *= Quaterniond(Eigen::AngleAxisd(error[3 + axis], Vector3d::Unit(axis)));
    }
  }
  return Trajectory(std::move(poses));
}

}  // namespace skycap::sim
