/// Frames of REP-103 and ours, and where the sensor is on the body that odometry speaks of.
///
/// World: the frame of the odometry, x east, y north, z up, in metres; the mission's frame. Body:
/// x forward, y left, z up (FLU). Sensor: the frame of the measured points, with axes either as the
/// body's or as a camera's (optical: x right, y down, z forward).
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "clients/ros2/messages.h"

namespace skycap::ros2 {

/// Of x y z rx ry rz, along and about the axes of the world, the turns about the body or sensor.
using Covariance = Eigen::Matrix<double, 6, 6>;

/// Where the body was.
struct BodyPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< world
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< world from body, of length one
  std::optional<Covariance> covariance;  ///< nothing if all of it is zero: not known
};

/// Throws Error{bad_geometry} saying what is wrong: numbers that are none, a quaternion whose
/// length is not one (within a hundredth), a covariance that is not symmetric or has negative
/// variances.
BodyPose body_pose(const Odometry& odometry);

/// The same of a transform: the child in its parent.
BodyPose body_pose(const TransformMessage& transform);

Eigen::Isometry3d isometry_of(const BodyPose& pose);

enum class Axes { optical, flu };

/// Rotation from a sensor's frame with these axes to its optical frame.
Eigen::Matrix3d optical_from(Axes axes);

/// The sensor on the body.
class Mount {
 public:
  Mount(const Eigen::Isometry3d& body_from_sensor, Axes axes);

  Axes axes() const { return axes_; }
  Eigen::Isometry3d world_from_optical(const BodyPose& body) const;
  Eigen::Isometry3d world_from_body(const Eigen::Isometry3d& world_from_optical) const;
  /// The body's covariance at the sensor: a turn of the body moves the sensor at the lever's end.
  std::optional<Covariance> covariance_at_sensor(const BodyPose& body) const;

 private:
  Axes axes_;
  Eigen::Isometry3d body_from_optical_;
};

/// Reads "x y z qx qy qz qw". Throws Error{bad_usage}; `what` opens messages.
Eigen::Isometry3d parse_extrinsic(const std::string& text, const std::string& what);

}  // namespace skycap::ros2
