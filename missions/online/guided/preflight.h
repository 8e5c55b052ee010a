/// Before a flight that is guided from here: is there a vehicle that can be flown, on the pad?
#pragma once

#include <stop_token>

#include <Eigen/Core>

#include "flight/link/autopilot_link.h"
#include "missions/online/guided/flight_frame.h"
#include "missions/online/guided/guided_limits.h"
#include "missions/online/guided/trouble.h"

namespace skycap::missions::online {

/// Waits for ArduCopter to be heard, asks it to say what is needed, and waits until it is sure
/// where it is: disarmed, on the pad.
MaybeTrouble prepare(flight::mavlink::AutopilotLink& link, const FlightFrame& frame,
                     const Eigen::Vector3d& pad, const GuidedLimits& limits,
                     const std::stop_token& stop);

}  // namespace skycap::missions::online
