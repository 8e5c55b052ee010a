/// View of a moving sensor: pose, time and motion.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "geometry/pose/platform.h"
#include "geometry/pose/pose.h"

namespace skycap::missions::session {

/// View during a flight.
struct ViewInFlight {
  geometry::View view;
  /// Velocity of the vehicle at mid-exposure [m/s].
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  double time = 0.0;  ///< Time since an arbitrary start before the first view [s].
  /// Motion during a continuous scan; empty for a scanner at rest.
  std::optional<geometry::Stretch> stretch{};
};

}  // namespace skycap::missions::session
