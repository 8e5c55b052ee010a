/// Processing of external scans in live surveys.
#pragma once

namespace skycap::missions::online {

struct LiveOptions {
  bool checks_poses = true;  ///< Reject scans that contradict the map.
  bool registers = false;    ///< Correct poses by registration with the map.
  double pose_sigma = 0.0;   ///< Default standard deviation of positions along each axis [m].
  /// Default standard deviation of rotations about each axis [rad].
  double pose_sigma_angle = 0.0;
  bool removes_flying_pixels = false;  ///< Remove flying pixels and isolated returns.
};

}  // namespace skycap::missions::online
