#include "geometry/pose/pose.h"

#include <cassert>
#include <cmath>

namespace skycap::geometry {

using Eigen::Vector3d;

Vector3d any_orthogonal(const Vector3d& axis) {
  Eigen::Index smallest = 0;
  axis.cwiseAbs().minCoeff(&smallest);
  return axis.cross(Vector3d::Unit(smallest)).normalized();
}

Eigen::Isometry3d camera_pose(const View& view) {
  const Vector3d forward = view.direction.normalized();
  const bool vertical = std::abs(forward.z()) > 1.0 - 1e-9;
  const Vector3d up = vertical ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d right = forward.cross(up).normalized();
  const Vector3d down = forward.cross(right);

  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.linear() << right, down, forward;
  world_from_camera.translation() = view.position;
  return world_from_camera;
}

View to_view(const Eigen::Isometry3d& world_from_camera) {
  return {world_from_camera.translation(), world_from_camera.linear().col(2)};
}

View look_at(const Vector3d& position, const Vector3d& target) {
  assert(position != target);
  return {position, (target - position).normalized()};
}

}  // namespace skycap::geometry
