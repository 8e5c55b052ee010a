/// Pose and view of a sensor.
///
/// World frame: local east-north-up [m]. Optical frame of a camera: x right, y down, z forward
/// along the viewing axis.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::geometry {

/// View as used by the planners: five degrees of freedom, with arbitrary roll (SEE++ §III).
struct View {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world frame [m]
  Eigen::Vector3d direction =
      Eigen::Vector3d::UnitX();  ///< unit vector from the sensor to the scene
};

/// Returns the pose world_from_camera of a camera with the view `view`. The top of the image points
/// towards world +z, or towards world +y if the view is vertical.
Eigen::Isometry3d camera_pose(const View& view);

/// Returns the view of a camera at `world_from_camera`. Inverse of camera_pose() except for the
/// roll.
View to_view(const Eigen::Isometry3d& world_from_camera);

/// Returns the view from `position` to `target`, which must differ.
View look_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target);

/// Returns a unit vector orthogonal to the unit vector `axis`. The result is deterministic.
Eigen::Vector3d any_orthogonal(const Eigen::Vector3d& axis);

}  // namespace skycap::geometry
