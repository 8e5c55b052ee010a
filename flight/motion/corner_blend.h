/// Rounded corners instead of stops on a polyline.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/motion/curve.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// Relative tolerance for the limit check of a slowed curve, because of rounding.
inline constexpr double limit_tolerance = 1e-9;

/// Shape of the curve at a corner.
struct CornerShape {
  /// Length of each adjacent line that the curve replaces [m]. 0: stop at the corner.
  double reach = 0.0;
  double handle = 0.0;  ///< Distance between control points, as a fraction of `reach`.
};

/// Rule for passing one point of a polyline.
struct CornerRule {
  /// Maximum distance between the point and the curve [m]. 0: stop at the point.
  double max_offset = std::numeric_limits<double>::infinity();
  double wait = 0.0;  ///< Rest time if the curve stops at the point [s].
  /// The only shape to try, if both adjacent lines are long enough. Otherwise the fastest shape is
  /// used.
  std::optional<CornerShape> shape{};
};

struct BlendedPath {
  Curve curve;
  std::vector<double> moments;      ///< Time at which the curve is closest to each point [s].
  std::vector<CornerShape> shapes;  ///< Shape at each point.
};

/// Returns a rest-to-rest motion along a polyline that observes the vehicle's limits. Straight
/// pieces have speed changes with limited jerk. Each corner has a quintic Bezier piece within the
/// corner's triangle, whose hull is verified at `clearance` [m]. The motion stops at a corner where
/// no such piece can be verified.
///
/// Assumes that the caller has verified the lines of the polyline. Requires at least two points, of
/// which consecutive ones differ. `rules` is empty or has one rule per point; the rules of both
/// ends are ignored. Deterministic.
BlendedPath blend_corners(const std::vector<Eigen::Vector3d>& points, const FreeSpace& space,
                          double clearance, const Motion& motion,
                          std::span<const CornerRule> rules = {});

}  // namespace skycap::flight
