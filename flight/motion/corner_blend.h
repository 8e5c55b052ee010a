/// Flying round the corners of a polyline instead of stopping in them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/motion/curve.h"
#include "flight/motion/motion.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// A motion from rest to rest along a polyline: straight pieces with jerk-limited changes of speed,
/// and in each corner a quintic Bezier piece, inside of the corner's triangle, whose hull is proven
/// to keep the clearance. Where no such piece is proven the corner is flown to and stopped in.
/// Keeps the vehicle's limits; deterministic. The straight pieces are taken to be proven by who
/// made the polyline. Expects at least two points, no two of them in a row equal.
Curve blend_corners(const std::vector<Eigen::Vector3d>& points, const FreeSpace& space,
                    double clearance, const Motion& motion);

}  // namespace skycap::flight
