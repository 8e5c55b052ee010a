#include "flight/motion/picture_bounds.h"

namespace skycap::flight {

PictureBounds picture_bounds(const Vehicle& vehicle, const geometry::Camera& camera,
                             const Shutter& shutter, double distance) {
  const Eigen::Vector2d focal = camera.focal_length_px();
  // Turning by a small angle moves a pixel at the slope s by at most f (1 + s^2) times the angle;
  // moving by a small way by at most f (1 + s^2)^(1/2) times the way over the depth.
  const Eigen::Vector2d corner =
      Eigen::Vector2d(camera.width(), camera.height()).cwiseQuotient(2.0 * focal);
  const double pixels = focal.maxCoeff() * (1.0 + corner.squaredNorm());
  const double speed = pixels * (vehicle.sway_rate + vehicle.sway_speed / distance);  // [px/s]
  return {speed * shutter.exposure, speed * shutter.readout, distance};
}

}  // namespace skycap::flight
