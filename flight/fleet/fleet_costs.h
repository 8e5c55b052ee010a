/// Lower bounds on the costs of a fleet's flights, before any leg is verified.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/fleet/fleet_problem.h"
#include "flight/motion/vehicle.h"
#include "flight/route/route.h"

namespace skycap::flight {

/// Clearance deficits of straight lines: 0 for verified lines. Empty lists: no deficits.
struct ClearanceDeficits {
  std::vector<double> home;  ///< From above the pad to each waypoint [m].
  std::vector<double> legs;  ///< From waypoint i to waypoint j at [i * count + j] [m].
};

/// Vehicle of a fleet with its route options. Its pad is options.takeoff.
struct FleetMember {
  Vehicle vehicle;
  RouteOptions options;

  Eigen::Vector3d home() const {
    return options.takeoff + Eigen::Vector3d(0.0, 0.0, options.takeoff_climb);
  }
};

/// Returns the deficits of the lines between waypoints [m].
std::vector<double> leg_clearance_deficits(std::span<const CapturePoint> capture_points,
                                           const FreeSpace& space, double clearance);
/// Returns the deficits of the lines from above a pad [m].
std::vector<double> return_clearance_deficits(std::span<const CapturePoint> capture_points,
                                              const Eigen::Vector3d& home, const FreeSpace& space,
                                              double clearance);

/// Returns lower bounds on the times of verified legs, for any corners and detours. Energies are
/// not bounded. Projected onto any direction, a rest-to-rest motion is a rest-to-rest motion with
/// the vehicle's maximum speed and acceleration in that direction. Where the straight line is not
/// free, the leg has one stop outside a ball around its worst position, or two stops.
FleetVehicle lower_bound_costs(std::span<const CapturePoint> capture_points,
                               const FleetMember& member,
                               const ClearanceDeficits& clearance_deficits = {});

}  // namespace skycap::flight
