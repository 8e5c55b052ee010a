/// Frames of REP-103 and of Skycap, and the sensor's mount on the body.
///
/// World: the frame of the odometry, which is the mission's frame; x east, y north, z up, in
/// metres. Body: x forward, y left, z up (FLU). Sensor: the frame of the measured points, with the
/// axes of the body or of a camera (optical: x right, y down, z forward).
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "clients/ros2/messages.h"

namespace skycap::ros2 {

/// Covariance of x y z rx ry rz along and around the world axes. Rotations are around the body or
/// sensor.
using Covariance = Eigen::Matrix<double, 6, 6>;

/// Pose of the body.
struct BodyPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< World frame [m].
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< World from body, unit quaternion.
  std::optional<Covariance> covariance;  ///< Empty if all elements are zero, which means unknown.
};

/// Returns the pose of an odometry message. Throws Error{bad_geometry} with the problem. Examples
/// are values that are not finite, a quaternion norm that differs from 1 by more than 0.01, and a
/// covariance that is asymmetric or has negative variances.
BodyPose body_pose(const Odometry& odometry);

/// Returns the pose of a transform: the child in its parent. Throws the same errors as the odometry
/// overload.
BodyPose body_pose(const TransformMessage& transform);

Eigen::Isometry3d to_isometry(const BodyPose& pose);

enum class Axes { optical, flu };

/// Returns the rotation from a sensor frame with these axes to its optical frame.
Eigen::Matrix3d optical_from(Axes axes);

/// Mount of the sensor on the body.
class Mount {
 public:
  Mount(const Eigen::Isometry3d& body_from_sensor, Axes axes);

  Axes axes() const { return axes_; }
  Eigen::Isometry3d world_from_optical(const BodyPose& body) const;
  Eigen::Isometry3d world_from_body(const Eigen::Isometry3d& world_from_optical) const;
  /// Returns the body covariance transformed to the sensor, with the effect of the lever arm.
  std::optional<Covariance> covariance_at_sensor(const BodyPose& body) const;

 private:
  Axes axes_;
  Eigen::Isometry3d body_from_optical_;
};

/// Parses "x y z qx qy qz qw". Throws Error{bad_usage} with `what` at the start of the message.
Eigen::Isometry3d parse_extrinsic(const std::string& text, const std::string& what);

}  // namespace skycap::ros2
