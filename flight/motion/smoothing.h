/// Legs without stops at corners. A proposed curve is used only if it can be verified.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/motion/curve.h"
#include "flight/motion/flight_style.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// Leg along a curve, from rest to rest.
struct SmoothLeg {
  Curve curve;
  double length = 0.0;
  double duration = 0.0;   ///< Duration without the settle time [s].
  double energy = 0.0;     ///< Electrical energy [J].
  double clearance = 0.0;  ///< Verified lower bound over the whole curve [m], see LegVerification.
};

/// Returns the curved leg along `points`, whose lines are verified at `clearance` [m]. The control
/// points of the derivatives bound speed, acceleration and jerk within the vehicle's limits.
/// Clearance is searched up to `up_to` [m]. Deterministic.
///
/// Returns std::nullopt without corners, for the styles `stop` and `pass` (see passage.h), or if no
/// verified curve is faster than stopping.
std::optional<SmoothLeg> smooth(const std::vector<Eigen::Vector3d>& points, const FreeSpace& space,
                                double clearance, double up_to, const Motion& motion,
                                FlightStyle style);

}  // namespace skycap::flight
