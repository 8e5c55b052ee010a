/// Simulated depth camera: pinhole rays against the scene, with the errors of a real sensor.
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera_config.h"

namespace skycap::sim {

/// Validated sensor. Immutable and thread-safe.
class DepthCamera {
 public:
  /// Throws the same errors as DepthCameraConfig::validate().
  explicit DepthCamera(const DepthCameraConfig& config);

  const DepthCameraConfig& config() const { return config_; }
  const geometry::Camera& camera() const { return camera_; }

  /// Returns the scan from `world_from_camera` (optical frame) in row order. A surface within the
  /// minimum range blocks the ray without a return. `frame` is the scan number, which determines
  /// the noise together with the seed. The result does not depend on `threads` (0: all processors).
  /// Without noise, a point is on the pixel's ray to single precision.
  ///
  /// `buffer` is an unused scan whose memory is reused. That saves 10% of the time for a frame of
  /// several megapixels.
  geometry::Scan scan(const Scene& scene, const Eigen::Isometry3d& world_from_camera,
                      std::uint64_t frame, unsigned threads = 0, geometry::Scan buffer = {}) const;

  /// Returns the scan of a moving camera with one estimated pose. The rays of a row are cast from
  /// the camera pose during its exposure. Their depths are then assigned to the rays of the
  /// estimated pose, so pose errors and a rolling shutter displace the points. The depths of a
  /// pixel's instants are averaged if they belong to one surface (within 2%); otherwise the pixel
  /// has no return.
  geometry::Scan scan(const Scene& scene, const Eigen::Isometry3d& estimated,
                      const FrameMotion& motion, std::uint64_t frame, unsigned threads = 0,
                      geometry::Scan buffer = {}) const;

  /// Returns the scan of a stationary camera at geometry::camera_pose(view).
  geometry::Scan scan(const Scene& scene, const geometry::View& view, std::uint64_t frame,
                      unsigned threads = 0, geometry::Scan buffer = {}) const;

 private:
  DepthCameraConfig config_;
  geometry::Camera camera_;
};

}  // namespace skycap::sim
