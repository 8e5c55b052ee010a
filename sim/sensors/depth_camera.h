/// A simulated depth camera: pinhole rays against the scene, with the errors of a real sensor.
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera_config.h"

namespace skycap::sim {

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

  /// What it measures while it moves, and is believed to be at one pose all the time: a row's rays
  /// are cast from where the camera is when it is exposed, and their depths taken to be those of
  /// the believed pose's rays. So errors of the pose and a rolling shutter displace the points. The
  /// depths of a pixel's instants make one if they are of one surface (within 2 %), and none else.
  geometry::Scan scan(const Scene& scene, const Eigen::Isometry3d& believed,
                      const FrameMotion& motion, std::uint64_t frame, unsigned threads = 0,
                      geometry::Scan recycled = {}) const;

  /// The same as the first from geometry::camera_pose(view).
  geometry::Scan scan(const Scene& scene, const geometry::View& view, std::uint64_t frame,
                      unsigned threads = 0, geometry::Scan recycled = {}) const;

 private:
  DepthCameraConfig config_;
  geometry::Camera camera_;
};

}  // namespace skycap::sim
