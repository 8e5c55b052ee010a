/// What the parts of a fleet's flights take, before any leg is proven.
#pragma once

#include <span>

#include <Eigen/Core>

#include "flight/fleet/fleet_problem.h"
#include "flight/motion/motion.h"
#include "flight/route/route.h"

namespace skycap::flight {

/// One vehicle of a fleet and its pad.
struct FleetMember {
  Motion motion;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  double takeoff_climb = 5.0;  ///< straight up from the pad before the first leg [m]
};

/// As if every leg were straight and free, in the times that plan_route() counts.
FleetVehicle straight_costs(std::span<const Station> stations, const FleetMember& member);

/// Times that no certified legs undercut, corners and detours as they may be; energies are not
/// looked at. A motion from rest to rest is, along any direction, one from rest to rest under the
/// greatest speed and acceleration that the vehicle has in that direction, whatever its way.
FleetVehicle least_costs(std::span<const Station> stations, const FleetMember& member);

}  // namespace skycap::flight
