/// Setpoints on a straight leg for an autopilot that continues with the last velocity received.
#pragma once

#include <Eigen/Core>

#include "flight/clearance/segment_distance.h"
#include "flight/monte_carlo/flight_script.h"

namespace skycap::missions::online {

/// Returns `point` with its velocity limited so that the vehicle stops before the end of the leg
/// even if no further setpoint arrives.
flight::SetPoint with_stopping_speed(const flight::ScriptedLeg& leg, flight::SetPoint point);

/// Returns the leg time of the next setpoint [s]. The last setpoint, `sent`, had leg time `time`
/// and was sent `late` seconds ago. The result is at or beyond the position reached with the
/// velocity of `sent`, so that the vehicle never flies backwards.
double time_after(const flight::ScriptedLeg& leg, double jerk, double time,
                  const flight::SetPoint& sent, double late);

/// Returns the point of the leg where a vehicle on it comes to rest if it brakes now with
/// `acceleration` [m/s^2].
Eigen::Vector3d stopping_point(const flight::Segment& leg, const Eigen::Vector3d& position,
                               const Eigen::Vector3d& velocity, double acceleration);

}  // namespace skycap::missions::online
