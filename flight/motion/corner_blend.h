/// Flying round the corners of a polyline instead of stopping in them.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/curve.h"
#include "flight/motion/motion.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// Rounding may make a curve that was slowed as needed look too fast by this share.
inline constexpr double limit_tolerance = 1e-9;

/// The shape of the curve round a corner.
struct CornerShape {
  double reach = 0.0;   ///< from so far before the corner to as far behind it; zero: a stop in it
  double handle = 0.0;  ///< of the reach, from a control point to the next
};

/// How one point of a polyline may be passed.
struct CornerRule {
  /// How far from it the curve may be where it is nearest [m]; zero: stop in it.
  double most_off = std::numeric_limits<double>::infinity();
  double wait = 0.0;  ///< at rest, where it is stopped in [s]
  /// The only one that is tried, as far as both pieces are long enough; else the fastest is chosen.
  std::optional<CornerShape> shape{};
};

struct BlendedWay {
  Curve curve;
  std::vector<double> moments;  ///< for each point, when the curve is nearest to it, or comes there
  std::vector<CornerShape> shapes;  ///< for each point
};

/// A motion from rest to rest along a polyline: straight pieces with jerk-limited changes of speed,
/// and in each corner a quintic Bezier piece, inside of the corner's triangle, whose hull is proven
/// to keep the clearance. Where no such piece is proven the corner is flown to and stopped in.
/// Keeps the vehicle's limits; deterministic. The straight pieces are taken to be proven by who
/// made the polyline. Expects at least two points, no two of them in a row equal, and a rule for
/// each point (those of both ends are not looked at) or none at all.
BlendedWay blend_corners(const std::vector<Eigen::Vector3d>& points, const FreeSpace& space,
                         double clearance, const Motion& motion,
                         std::span<const CornerRule> rules = {});

}  // namespace skycap::flight
