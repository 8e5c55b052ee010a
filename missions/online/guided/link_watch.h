/// Monitoring of the link, the vehicle's position estimate and its flight mode.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "flight/link/vehicle_state.h"
#include "missions/online/guided/flight_frame.h"
#include "missions/online/guided/trouble.h"

namespace skycap::missions::online {

/// Returns true if the estimator reports valid attitude, velocity, position and height.
bool is_sure_of_place(const flight::mavlink::VehicleState& state);

/// Returns the estimated position in the mission frame. A position message must have been received.
Eigen::Vector3d place_of(const flight::mavlink::VehicleState& state, const FlightFrame& frame);

/// Returns the current problem of a flying vehicle that was commanded to `mode`, if any. `now` is
/// the link time [s].
MaybeTrouble watch_link(const flight::mavlink::VehicleState& state, std::uint32_t mode, double now);

}  // namespace skycap::missions::online
