/// Bounds on the image sharpness of a vehicle, hovering or in flight.
#pragma once

#include "flight/motion/vehicle.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/platform.h"

namespace skycap::flight {

/// Maximum image motion of surfaces at `distance`, anywhere in the image, caused by hover drift and
/// camera rotation as specified in the vehicle profile.
struct ImageMotionBounds {
  double blur_px = 0.0;  ///< Motion blur during the exposure of one pixel.
  /// Rolling-shutter skew between the exposures of the first and last rows.
  double shear_px = 0.0;
  double distance = 0.0;  ///< Distance of the surfaces [m].

  /// Maximum image motion that counts as sharp [px].
  static constexpr double sharp_px = 1.0;
  bool is_sharp() const { return blur_px <= sharp_px && shear_px <= sharp_px; }
};

ImageMotionBounds image_motion_bounds(const Vehicle& vehicle, const geometry::Camera& camera,
                                      const geometry::Shutter& shutter, double distance);

/// Returns the maximum ground speed for sharp images [m/s]. It is infinite for a shutter without
/// exposure time, and 0 if images are not sharp even in hover.
double sharp_speed(const Vehicle& vehicle, const geometry::Camera& camera,
                   const geometry::Shutter& shutter, double distance);

}  // namespace skycap::flight
