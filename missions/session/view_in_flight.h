/// A view of a sensor that is flown: where, when, and how the vehicle moves meanwhile.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "geometry/place/platform.h"
#include "geometry/place/pose.h"

namespace skycap::missions::session {

/// A view in a flight.
struct ViewInFlight {
  geometry::View view;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the vehicle, in the middle [m/s]
  double time = 0.0;                                   ///< since some moment before the first [s]
  /// Of a scanner that measures in flight; none: it stands.
  std::optional<geometry::Stretch> stretch{};
};

}  // namespace skycap::missions::session
