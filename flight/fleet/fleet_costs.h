/// What the parts of a fleet's flights take at least, before any leg is proven.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/fleet/fleet_problem.h"
#include "flight/motion/vehicle.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// How much nearer than the clearance straight lines come to what is not free; 0 where they are
/// proven. Empty lists: all are.
struct Shortfalls {
  std::vector<double> home;  ///< from above the pad to each station [m]
  std::vector<double> legs;  ///< from station i to station j at [i * count + j] [m]
};

/// One vehicle of a fleet, and how it flies; its pad is options.takeoff.
struct FleetMember {
  Vehicle vehicle;
  RouteOptions options;

  Eigen::Vector3d home() const {
    return options.takeoff + Eigen::Vector3d(0.0, 0.0, options.takeoff_climb);
  }
};

/// Of the lines between stations.
std::vector<double> leg_shortfalls(std::span<const Station> stations, const FreeSpace& space,
                                   double clearance);
/// Of the lines from above a pad.
std::vector<double> home_shortfalls(std::span<const Station> stations, const Eigen::Vector3d& home,
                                    const FreeSpace& space, double clearance);

/// Times that no certified legs undercut, corners and detours as they may be; energies are not
/// looked at. A motion from rest to rest is, along any direction, one from rest to rest under the
/// greatest speed and acceleration that the vehicle has in that direction, whatever its way. Where
/// the straight line is not free there is a stop at a corner, outside of a ball about the line's
/// worst place, or there are two.
FleetVehicle least_costs(std::span<const Station> stations, const FleetMember& member,
                         const Shortfalls& shortfalls = {});

}  // namespace skycap::flight
