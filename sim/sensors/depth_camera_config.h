/// What a mission says of a simulated depth camera.
#pragma once

#include <numbers>

#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "sim/sensors/noise.h"

namespace skycap::sim {

/// Errors of a camera that triangulates: depth is z = f B / disparity, so an error s of the
/// disparity is one of s z^2 / (f B) in depth, and depths come in steps of about z^2 step / (f B).
/// The noise comes before the rounding. All zero: off.
struct StereoErrors {
  double focal_length_px = 0.0;     ///< f, of the imagers that are matched
  double baseline = 0.0;            ///< B [m]
  double disparity_sigma_px = 0.0;  ///< s
  double disparity_step_px = 0.0;   ///< disparities are multiples of it; zero: not rounded

  bool is_on() const { return disparity_sigma_px > 0.0 || disparity_step_px > 0.0; }
};

struct DepthCameraConfig {
  geometry::CameraConfig camera;
  NoiseConfig noise;  ///< added to the points after the errors of the depth
  StereoErrors stereo;
  /// No return from surfaces whose normal makes a larger angle than this with the ray [rad], in
  /// (0, pi/2]; pi/2 switches the limit off.
  double max_incidence = 0.5 * std::numbers::pi;

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// How a camera really moves while it takes a frame: evenly.
struct FrameMotion {
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  ///< amid the frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();                   ///< world frame [m/s]
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();  ///< about world axes [rad/s]
  double exposure = 0.0;                                ///< of each row [s]
  double readout = 0.0;  ///< from the first row's exposure to the last one's [s]; zero: global
  int instants = 1;      ///< evenly over it, which stand for the exposure; at least one

  /// Where the camera is so long after the middle of the frame [s].
  Eigen::Isometry3d pose(double time) const;
};

/// The RealSense D435 of the SEE++ experiments: 848 x 480 pixels, 69.4 x 42.5 degrees, isotropic
/// noise of 0.01 m (paper §IV-A).
DepthCameraConfig d435();

/// The paper's sensor for the full-size building: 2400 x 1750 pixels, 60 x 40 degrees, isotropic
/// noise of 0.01 m (paper §IV-A).
DepthCameraConfig high_resolution();

}  // namespace skycap::sim
