/// Checks before a guided flight: a suitable vehicle is connected and is on the pad.
#pragma once

#include <stop_token>

#include <Eigen/Core>

#include "flight/mavlink/autopilot_link.h"
#include "missions/online/guided/flight_failure.h"
#include "missions/online/guided/flight_frame.h"
#include "missions/online/guided/guided_limits.h"

namespace skycap::missions::online {

/// Waits for messages of an ArduCopter, requests the required message rates, and waits for a valid
/// position estimate. The vehicle must be disarmed and on the pad. Returns the first check that
/// fails.
MaybeFailure prepare(flight::mavlink::AutopilotLink& link, const FlightFrame& frame,
                     const Eigen::Vector3d& pad, const GuidedLimits& limits,
                     const std::stop_token& stop);

}  // namespace skycap::missions::online
