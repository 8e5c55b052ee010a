/// Curve of the dome, shared by its shell, ribs and lead rolls.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "sim/models/radcliffe_camera.h"

namespace skycap::sim::models::radcliffe {

/// Arc in the plane (distance from the axis, z), vertical at the springing, up to the platform of
/// the lantern. Positions on it are angles from the springing.
class Meridian {
 public:
  explicit Meridian(const RadcliffeTable& table) : foot_(table.dome_foot()) {
    // The arc passes through (dome_radius, 0) and (top, rise) with its centre (c, 0) at the level
    // of the springing: (top - c)^2 + rise^2 = (dome_radius - c)^2.
    const double top = table.lantern_radius + 0.5, rise = table.dome_rise - 0.1;
    const double wide = table.dome_radius;
    centre_ = (wide * wide - top * top - rise * rise) / (2.0 * (wide - top));
    radius_ = wide - centre_;
    angle_ = std::atan2(rise, top - centre_);
  }

  double radius() const { return radius_; }
  double angle() const { return angle_; }  ///< Angle of the whole arc [rad].
  /// Returns the point `out` metres outside the curve.
  Eigen::Vector2d point(double angle, double out = 0.0) const {
    return {centre_ + (radius_ + out) * std::cos(angle), foot_ + (radius_ + out) * std::sin(angle)};
  }

 private:
  double foot_, centre_, radius_, angle_;
};

}  // namespace skycap::sim::models::radcliffe
