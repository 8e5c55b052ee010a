/// Position, speed and aiming errors of a vehicle at a view.
#pragma once

#include <string>

#include "geometry/angle.h"

namespace skycap::missions::online {

/// Speed below which the vehicle counts as at rest [m/s].
inline constexpr double rest_speed = 0.2;
inline constexpr double aim_tolerance = 2.0 * geometry::radians_per_degree;

struct AimErrors {
  double position = 0.0;       ///< Distance from the target position [m].
  double speed = 0.0;          ///< [m/s]
  double turn = 0.0;           ///< Absolute heading error [rad].
  double pitch = 0.0;          ///< Measured camera pitch relative to the horizon [rad].
  double asked_pitch = 0.0;    ///< Commanded camera pitch relative to the horizon [rad].
  double vehicle_pitch = 0.0;  ///< Pitch of the airframe, positive nose up [rad].
};

/// Describes the errors that exceed their tolerances, for messages. Returns an empty string if all
/// are within tolerance. `arrival` is the position tolerance [m].
std::string describe_failures(const AimErrors& errors, double arrival);

}  // namespace skycap::missions::online
