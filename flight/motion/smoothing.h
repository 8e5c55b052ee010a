/// Legs without stops at their corners: curves that are proposed and then proved, or not flown.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/curve.h"
#include "flight/motion/flight_style.h"
#include "flight/motion/motion.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// A leg flown along a curve, from rest to rest.
struct SmoothLeg {
  Curve curve;
  double length = 0.0;
  double duration = 0.0;   ///< moving [s]
  double energy = 0.0;     ///< [J]
  double clearance = 0.0;  ///< proven lower bound over the whole curve, see LegProof
};

/// The leg along `points`, whose straight pieces are proven at `clearance`, in that style. Nothing
/// if it has no corner, if the style stops in corners or passes views (passage.h), or if no curve
/// is both proven at the clearance and faster than stopping. Speed, acceleration and jerk keep the
/// vehicle's limits everywhere, by the control points of the derivatives. Clearance is looked at up
/// to `up_to`. Deterministic.
std::optional<SmoothLeg> smooth(const std::vector<Eigen::Vector3d>& points, const FreeSpace& space,
                                double clearance, double up_to, const Motion& motion,
                                FlightStyle style);

}  // namespace skycap::flight
