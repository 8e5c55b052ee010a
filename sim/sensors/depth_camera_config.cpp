#include "sim/sensors/depth_camera_config.h"

#include <cmath>

#include "geometry/angle.h"
#include "geometry/requirement.h"

namespace skycap::sim {

namespace {

constexpr double degree = geometry::radians_per_degree;

}  // namespace

void DepthCameraConfig::validate() const {
  camera.validate();
  noise.validate();
  require(max_incidence > 0.0 && max_incidence <= 0.5 * std::numbers::pi, "max_incidence",
          max_incidence, "greater than 0 and at most pi/2 radians");
  require(stereo.disparity_sigma_px >= 0.0 && std::isfinite(stereo.disparity_sigma_px),
          "stereo.disparity_sigma_px", stereo.disparity_sigma_px, "zero or more pixels");
  require(stereo.disparity_step_px >= 0.0 && std::isfinite(stereo.disparity_step_px),
          "stereo.disparity_step_px", stereo.disparity_step_px, "zero or more pixels");
  const double product = stereo.focal_length_px * stereo.baseline;
  require(!stereo.is_on() || (product > 0.0 && std::isfinite(product)),
          "stereo.focal_length_px * baseline", product, "greater than zero");
}

Eigen::Isometry3d FrameMotion::pose(double time) const {
  Eigen::Isometry3d pose = world_from_camera;
  pose.translation() += time * velocity;
  const double angle = time * turn_rate.norm();
  if (angle != 0.0) {
    pose.linear() =
        Eigen::AngleAxisd(angle, turn_rate.normalized()).toRotationMatrix() * pose.linear();
  }
  return pose;
}

DepthCameraConfig d435() {
  return {.camera = {.width = 848,
                     .height = 480,
                     .horizontal_fov = 69.4 * degree,
                     .vertical_fov = 42.5 * degree},
          .noise = {.sigma = 0.01}};
}

DepthCameraConfig high_resolution() {
  return {.camera = {.width = 2400,
                     .height = 1750,
                     .horizontal_fov = 60.0 * degree,
                     .vertical_fov = 40.0 * degree},
          .noise = {.sigma = 0.01}};
}

}  // namespace skycap::sim
