/// Smoother and faster ways than round corners: the whole curve at once, by Ceres.
///
/// Minimises the integral of the squared jerk (Mellinger & Kumar, Minimum Snap Trajectory
/// Generation and Control for Quadrotors, ICRA 2011, section IV, for the derivative one lower) over
/// the states at the joints of pieces of equal duration, with soft walls before the speed limits
/// and around what is not free. Then the duration is shortened, for as long as that makes the
/// flight faster once it is slowed to keep all limits.
#pragma once

#include "flight/motion/curve.h"
#include "flight/motion/motion.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// A curve between the same two places at rest, twice continuously differentiable: a proposal. It
/// keeps the vehicle's limits, being slowed as needed, but nothing is proven of its clearance; the
/// wall stands at `wanted_clearance`. Deterministic. `start` must not be empty.
Curve refine(const Curve& start, const FreeSpace& space, double wanted_clearance,
             const Motion& motion);

}  // namespace skycap::flight
