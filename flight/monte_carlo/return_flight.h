/// Return as flown by one vehicle. RtlProfile permits many, because it leaves open how corners are
/// cut and how DJI vehicles behave within tens of metres of the pad.
///
/// Implemented from the autopilots' sources and manuals (return_law.h), independently of the proof.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/monte_carlo/flight_script.h"
#include "flight/rtl/rtl_profile.h"
#include "geometry/random_numbers.h"

namespace skycap::flight {

/// Returns the corners of a return from a position to the ground, including the start. The law must
/// have exactly one dialect.
std::vector<Eigen::Vector3d> return_path(const RtlProfile& rtl_profile,
                                         const Eigen::Vector3d& position,
                                         geometry::RandomNumbers& random);

/// Returns that flight as a script, after an initial wait at rest. Below RtlProfile::landing_climb,
/// the descent counts as above the pad.
FlightScript return_script(const RtlProfile& rtl_profile, const Motion& motion,
                           const Eigen::Vector3d& position, geometry::RandomNumbers& random);

}  // namespace skycap::flight
