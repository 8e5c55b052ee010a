/// Checks before a guided flight: a suitable vehicle is connected and is on the pad.
#pragma once

#include <stop_token>

#include <Eigen/Core>

#include "flight/mavlink/autopilot_link.h"
#include "flight/motion/vehicle.h"
#include "missions/online/guided/flight_failure.h"
#include "missions/online/guided/flight_frame.h"
#include "missions/online/guided/guided_limits.h"

namespace skycap::missions::online {

/// Waits for ArduCopter to be heard, asks it to say what is needed, and waits until it is sure
/// where it is: disarmed, on the pad. Then checks that its parameters fit guided flight, and that
/// its gimbal turns, unless the vehicle has a fixed camera.
MaybeFailure prepare(flight::mavlink::AutopilotLink& link, const FlightFrame& frame,
                     const Eigen::Vector3d& pad, const flight::Vehicle& vehicle,
                     const GuidedLimits& limits, const std::stop_token& stop);

}  // namespace skycap::missions::online
