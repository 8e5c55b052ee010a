/// Set points on a straight leg for an autopilot that flies on with the velocity of the last one.
#pragma once

#include <Eigen/Core>

#include "flight/fly_test/flight_script.h"
#include "flight/space/segment_distance.h"

namespace skycap::missions::online {

/// The set point with a velocity from which the vehicle comes to rest before the leg's end, even if
/// no other follows.
flight::SetPoint with_stopping_speed(const flight::ScriptedLeg& leg, flight::SetPoint point);

/// The time on the leg whose set point is next, `late` seconds after `sent`, which was that of
/// `time`: where its velocity has led the vehicle to, so that it never flies back [s].
double time_after(const flight::ScriptedLeg& leg, double jerk, double time,
                  const flight::SetPoint& sent, double late);

/// Where a vehicle that flies along a leg comes to rest if it brakes now, on the leg.
Eigen::Vector3d stopping_place(const flight::Segment& leg, const Eigen::Vector3d& position,
                               const Eigen::Vector3d& velocity, double acceleration);

}  // namespace skycap::missions::online
