/// Settings of a simulated depth camera.
#pragma once

#include <numbers>

#include <Eigen/Geometry>

#include "geometry/pose/camera.h"
#include "sim/sensors/noise.h"

namespace skycap::sim {

/// Errors of a stereo camera. Depth is z = f B / disparity. A disparity error s causes a depth
/// error of s z^2 / (f B), and a disparity step causes depth steps of about z^2 step / (f B). Noise
/// is applied before rounding. All zero: off.
struct StereoErrors {
  double focal_length_px = 0.0;     ///< f of the matched imagers.
  double baseline = 0.0;            ///< B [m].
  double disparity_sigma_px = 0.0;  ///< Standard deviation s of the disparity.
  double disparity_step_px = 0.0;   ///< Rounding step of disparities. 0: not rounded.

  bool is_on() const { return disparity_sigma_px > 0.0 || disparity_step_px > 0.0; }
};

struct DepthCameraConfig {
  geometry::CameraConfig camera;
  NoiseConfig noise;  ///< Noise of the points, added after the depth errors.
  StereoErrors stereo;
  /// Maximum angle of incidence for a return [rad], in (0, pi/2]. pi/2 disables the limit.
  double max_incidence = 0.5 * std::numbers::pi;

  /// Throws Error{bad_config} naming the first field outside its interval.
  void validate() const;
};

/// True camera motion during a frame, at constant velocity.
struct FrameMotion {
  /// Pose at the middle of the frame.
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();   ///< World frame [m/s].
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();  ///< Around the world axes [rad/s].
  double exposure = 0.0;                                ///< Exposure of each row [s].
  /// Time between the exposures of the first and last rows [s]. 0: global shutter.
  double readout = 0.0;
  int instants = 1;  ///< Number of instants that sample the exposure evenly, at least one.

  /// Returns the camera pose at `time` after the middle of the frame [s].
  Eigen::Isometry3d pose(double time) const;
};

/// Returns the RealSense D435 of the SEE++ experiments: 848 x 480 pixels, 69.4 x 42.5 degrees,
/// isotropic noise of 0.01 m (paper §IV-A).
DepthCameraConfig d435();

/// Returns the paper's sensor for the full-size building: 2400 x 1750 pixels, 60 x 40 degrees,
/// isotropic noise of 0.01 m (paper §IV-A).
DepthCameraConfig high_resolution();

}  // namespace skycap::sim
