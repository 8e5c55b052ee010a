/// How far a vehicle at a view is from being at rest there and looking as it is asked to.
#pragma once

#include <string>

#include "geometry/angle.h"

namespace skycap::missions::online {

inline constexpr double rest_speed = 0.2;  ///< a vehicle that is slower stands [m/s]
inline constexpr double aim_tolerance = 2.0 * geometry::radians_per_degree;

struct AimErrors {
  double position = 0.0;       ///< from its place [m]
  double speed = 0.0;          ///< [m/s]
  double turn = 0.0;           ///< of the heading, without a sign [rad]
  double pitch = 0.0;          ///< of the camera, from the horizon [rad]
  double asked_pitch = 0.0;    ///< [rad]
  double vehicle_pitch = 0.0;  ///< nose up [rad]
};

/// Which of position, speed, heading and gimbal is off, and by how much, for messages; empty if
/// none is. `arrival` is how far it may be from its place [m].
std::string failures_of(const AimErrors& errors, double arrival);

}  // namespace skycap::missions::online
