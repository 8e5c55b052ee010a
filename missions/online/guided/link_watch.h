/// Monitoring of the link, the vehicle's position estimate and its flight mode.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "flight/mavlink/vehicle_state.h"
#include "missions/online/guided/flight_failure.h"
#include "missions/online/guided/flight_frame.h"

namespace skycap::missions::online {

/// Returns true if the estimator reports valid attitude, velocity, position and height.
bool has_position_estimate(const flight::mavlink::VehicleState& state);

/// Returns the estimated position in the mission frame. A position message must have been received.
Eigen::Vector3d to_position(const flight::mavlink::VehicleState& state, const FlightFrame& frame);

/// Returns the current problem of a flying vehicle that was commanded to `mode`, if any. `now` is
/// the link time [s].
MaybeFailure watch_link(const flight::mavlink::VehicleState& state, std::uint32_t mode, double now);

}  // namespace skycap::missions::online
