/// The way home as one vehicle flies it: one of the many that ReturnLaw allows, for it leaves open
/// how far corners are cut, and what DJI's vehicles do within tens of metres of the pad.
///
/// Written from the autopilots' sources and manuals (return_law.h), not from the proof.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/fly_test/flight_script.h"
#include "flight/way_home/return_law.h"
#include "geometry/random_numbers.h"

namespace skycap::flight {

/// The corners of the way from a place to the ground, itself the first. The law's dialects must be
/// one.
std::vector<Eigen::Vector3d> return_way(const ReturnLaw& law, const Eigen::Vector3d& place,
                                        geometry::RandomNumbers& random);

/// That way in time, after a first wait where the vehicle has come to rest. Below
/// ReturnLaw::landing_climb its descent is over the pad.
FlightScript return_script(const ReturnLaw& law, const Motion& motion, const Eigen::Vector3d& place,
                           geometry::RandomNumbers& random);

}  // namespace skycap::flight
