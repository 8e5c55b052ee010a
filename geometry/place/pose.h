/// Where a sensor is and which way it looks.
///
/// World frame: local east-north-up, metres, z up. Optical frame of a camera: x right, y down,
/// z forward along the viewing axis.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::geometry {

/// A view as the planners speak of it: five degrees of freedom, the roll is free (SEE++ §III).
struct View {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< world frame
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, from the sensor to the scene
};

/// The pose world_from_camera of a camera that takes `view` with the image's top towards world
/// +z. A view straight up or down has the image's top towards world +y.
Eigen::Isometry3d camera_pose(const View& view);

/// The view that a camera at `world_from_camera` takes: inverse of camera_pose() but for the roll.
View view_of(const Eigen::Isometry3d& world_from_camera);

/// The view from `position` to `target`. The two must differ.
View look_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target);

/// Any unit vector orthogonal to the unit vector `axis`; the same one for the same axis.
Eigen::Vector3d any_orthogonal(const Eigen::Vector3d& axis);

}  // namespace skycap::geometry
