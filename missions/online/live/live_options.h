/// What is made of scans that come from outside, in live surveys.
#pragma once

namespace skycap::missions::online {

struct LiveOptions {
  bool checks_poses = true;            ///< scans that contradict what is known are set aside
  bool registers = false;              ///< their poses are corrected by what is known
  double pose_sigma = 0.0;             ///< of a scan that says none: standard deviation, each axis
  double pose_sigma_angle = 0.0;       ///< and about each axis [rad]
  bool removes_flying_pixels = false;  ///< and isolated returns
};

}  // namespace skycap::missions::online
