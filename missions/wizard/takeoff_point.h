/// Take-off point of a mission for a known structure that does not set one.
#pragma once

#include <span>

#include <Eigen/Core>

#include "flight/flight_options.h"
#include "geometry/pose/pose.h"

namespace skycap::missions::wizard {

/// Returns the pad of the mission, in the mission frame. Without flight.takeoff, it is on free,
/// even ground inside the geofence, beside the box around the unknown boxes and all views. For DJI
/// vehicles it is so far from the views that each return begins with a climb (PadSearch).
/// Without such ground, it is the pad of flight::FlightOptions::pad(). `views` must not be empty.
Eigen::Vector3d choose_takeoff(const flight::FlightOptions& options,
                               std::span<const geometry::View> views);

}  // namespace skycap::missions::wizard
