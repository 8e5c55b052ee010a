/// A simulated depth camera: pinhole rays against the scene, with the errors of a real sensor.
#pragma once

#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "sim/scene/scene.h"
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

/// The RealSense D435 of the SEE++ experiments: 848 x 480 pixels, 69.4 x 42.5 degrees, isotropic
/// noise of 0.01 m (paper §IV-A).
DepthCameraConfig d435();

/// The paper's sensor for the full-size building: 2400 x 1750 pixels, 60 x 40 degrees, isotropic
/// noise of 0.01 m (paper §IV-A).
DepthCameraConfig high_resolution();

/// A validated sensor. Immutable; safe to use from any number of threads.
class DepthCamera {
 public:
  /// Throws what DepthCameraConfig::validate() throws.
  explicit DepthCamera(const DepthCameraConfig& config);

  const DepthCameraConfig& config() const { return config_; }
  const geometry::Camera& camera() const { return camera_; }

  /// What the camera measures from `world_from_camera` (optical frame), in row order. A surface
  /// nearer than the camera's minimum range hides what is behind it and gives no return. `frame`
  /// numbers the camera's scans: with the seed, it alone decides the noise. The result does not
  /// depend on `threads` (zero: all processors). Without noise a point is on the pixel's ray to
  /// single precision. A scan that is not needed any more can be handed in as `recycled`: its
  /// memory is used again, which saves a tenth of the time of a frame of some megapixels.
  geometry::Scan scan(const Scene& scene, const Eigen::Isometry3d& world_from_camera,
                      std::uint64_t frame, unsigned threads = 0,
                      geometry::Scan recycled = {}) const;

  /// The same from geometry::camera_pose(view).
  geometry::Scan scan(const Scene& scene, const geometry::View& view, std::uint64_t frame,
                      unsigned threads = 0, geometry::Scan recycled = {}) const;

 private:
  DepthCameraConfig config_;
  geometry::Camera camera_;
};

}  // namespace skycap::sim
