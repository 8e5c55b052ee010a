/// How the ground lies where a mission's vehicle takes off and lands.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/route/pad_ground.h"
#include "missions/config/mission.h"

namespace skycap::missions::config {

/// How far from a pad's middle the vehicle's feet may come down.
double pad_radius_of(const config::Mission& mission);

/// Where the vehicle lands: the pad, then the rally points.
std::vector<Eigen::Vector3d> landings_of(const config::Mission& mission,
                                         const Eigen::Vector3d& pad);

/// The ground of each of these that it is known of: what `measured` holds for the place, else as
/// flight.pad_slope_deg declares it, else by the terrain of the prior data.
std::vector<flight::PadGround> grounds_of(const config::Mission& mission,
                                          const Eigen::Vector3d& pad,
                                          std::span<const flight::PadGround> measured);

/// What these must be.
flight::PadLimits ground_limits_of(const config::Mission& mission);

}  // namespace skycap::missions::config
