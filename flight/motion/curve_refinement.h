/// Global optimisation of a curve with Ceres, for smoother and faster flight than with rounded
/// corners.
///
/// Minimises the integral of the squared jerk over the states at the joints of pieces of equal
/// duration. The method follows Mellinger & Kumar (Minimum Snap Trajectory Generation and Control
/// for Quadrotors, ICRA 2011, section IV), with a derivative one order lower. Penalty terms act
/// before the speed limits and near space that is not free. Afterwards the duration is reduced as
/// long as the curve, slowed to all limits, becomes faster.
#pragma once

#include "flight/clearance/clearance.h"
#include "flight/motion/curve.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// Returns a twice continuously differentiable curve between the same end positions, at rest at
/// both. The curve observes the vehicle's limits, but its clearance is not verified. The obstacle
/// penalty starts at `target_clearance` [m]. `start` must not be empty. Deterministic.
Curve refine(const Curve& start, const FreeSpace& space, double target_clearance,
             const Motion& motion);

}  // namespace skycap::flight
