/// Whether an autopilot is still heard, knows where it is, and does what it was told from here.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "flight/link/vehicle_state.h"
#include "missions/online/guided/flight_frame.h"
#include "missions/online/guided/trouble.h"

namespace skycap::missions::online {

/// Whether the vehicle's estimator is sure of attitude, velocity, place and height.
bool is_sure_of_place(const flight::mavlink::VehicleState& state);

/// Where the vehicle takes itself to be; its position must have been heard.
Eigen::Vector3d place_of(const flight::mavlink::VehicleState& state, const FlightFrame& frame);

/// What is wrong at `now` with a vehicle in flight that was told to be in `mode`.
MaybeTrouble watch_link(const flight::mavlink::VehicleState& state, std::uint32_t mode, double now);

}  // namespace skycap::missions::online
