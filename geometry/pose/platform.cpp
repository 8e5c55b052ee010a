#include "geometry/pose/platform.h"

#include <cmath>
#include <numbers>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

View turned_level(const Vector3d& position, const Vector3d& direction, double angle) {
  const Vector3d level(direction.x(), direction.y(), 0.0);
  return {position, Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * level.normalized()};
}

}  // namespace

Eigen::Quaterniond make_rotation(const Vector3d& angles) {
  return Eigen::AngleAxisd(angles.z(), Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles.y(), Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Vector3d::UnitX());
}

View nose_view(const ScannerMount& mount, const View& view) {
  const Vector3d right = camera_pose(view).linear().col(0);  // level
  return turned_level(view.position, right, 0.5 * std::numbers::pi - mount.view_azimuth);
}

View scanner_view(const ScannerMount& mount, const View& nose) {
  View view = turned_level(nose.position, nose.direction, mount.view_azimuth);
  if (mount.view_pitch != 0.0) {
    view.direction *= std::cos(mount.view_pitch);
    view.direction.z() = std::sin(mount.view_pitch);
  }
  return view;
}

}  // namespace skycap::geometry
