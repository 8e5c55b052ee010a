#include "flight/motion/image_motion_bounds.h"

#include <algorithm>
#include <limits>

namespace skycap::flight {
namespace {

/// Returns the maximum image motion per small camera rotation [px/rad], which is f (1 + s^2) at the
/// slope s. A small translation moves a pixel by at most f (1 + s^2)^(1/2) times the ratio of
/// translation to depth.
double pixels_per_radian(const geometry::Camera& camera) {
  const Eigen::Vector2d focal = camera.focal_length_px();
  const Eigen::Vector2d corner =
      Eigen::Vector2d(camera.width(), camera.height()).cwiseQuotient(2.0 * focal);
  return focal.maxCoeff() * (1.0 + corner.squaredNorm());
}

}  // namespace

double sharp_speed(const Vehicle& vehicle, const geometry::Camera& camera,
                   const geometry::Shutter& shutter, double distance) {
  const double time = std::max(shutter.exposure, shutter.readout);
  if (time == 0.0) return std::numeric_limits<double>::infinity();
  const double turning =
      ImageMotionBounds::sharp_px / (pixels_per_radian(camera) * time);  // [rad/s].
  return std::max(0.0, (turning - vehicle.sway_rate) * distance - vehicle.sway_speed);
}

ImageMotionBounds image_motion_bounds(const Vehicle& vehicle, const geometry::Camera& camera,
                                      const geometry::Shutter& shutter, double distance) {
  const double speed =
      pixels_per_radian(camera) * (vehicle.sway_rate + vehicle.sway_speed / distance);  // [px/s].
  return {speed * shutter.exposure, speed * shutter.readout, distance};
}

}  // namespace skycap::flight
