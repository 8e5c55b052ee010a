/// A simulated depth camera: pinhole rays against the scene, with the errors of a real sensor.
#pragma once

#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

#include "geometry/camera.h"
#include "geometry/pose.h"
#include "geometry/scan.h"
#include "sim/noise.h"
#include "sim/scene.h"

namespace skycap::sim {

struct DepthCameraConfig {
  geometry::CameraConfig camera;
  NoiseConfig noise;
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
