/// How sharp pictures are that a vehicle takes, at rest or in passing.
#pragma once

#include "flight/motion/vehicle.h"
#include "geometry/place/camera.h"
#include "geometry/place/platform.h"

namespace skycap::flight {

/// How far what is `distance` away moves at most over the image, anywhere in it, while the vehicle
/// sways and its camera turns as it says of itself.
struct PictureBounds {
  double blur_px = 0.0;   ///< while a pixel is exposed
  double shear_px = 0.0;  ///< between the exposures of the first row and of the last
  double distance = 0.0;  ///< [m]

  /// More than that is seen.
  static constexpr double sharp_px = 1.0;
  bool is_sharp() const { return blur_px <= sharp_px && shear_px <= sharp_px; }
};

PictureBounds picture_bounds(const Vehicle& vehicle, const geometry::Camera& camera,
                             const geometry::Shutter& shutter, double distance);

/// The greatest speed over the ground at which pictures are sharp [m/s]: infinite for a shutter
/// that takes no time, zero where they are not even at rest.
double sharp_speed(const Vehicle& vehicle, const geometry::Camera& camera,
                   const geometry::Shutter& shutter, double distance);

}  // namespace skycap::flight
