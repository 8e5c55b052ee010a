#include "flight/motion/smoothing.h"

#include <algorithm>
#include <array>

#include "flight/motion/corner_blend.h"
#include "flight/motion/curve_refinement.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Distances beyond the clearance, relative to it, for the penalty of a refined curve. Since
/// penalties are soft, the next value is used if verification fails.
constexpr std::array wall_offsets{0.03, 0.1, 0.3};

std::vector<Vector3d> without_repeats(std::vector<Vector3d> points) {
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

double stopping_time(const std::vector<Vector3d>& points, const Motion& motion) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += motion.leg_time(points[i] - points[i - 1]);
  return sum;
}

}  // namespace

std::optional<SmoothLeg> smooth(const std::vector<Vector3d>& requested, const FreeSpace& space,
                                double clearance, double up_to, const Motion& motion,
                                FlightStyle style) {
  const std::vector<Vector3d> points = without_repeats(requested);
  const bool is_curved = style == FlightStyle::blend || style == FlightStyle::smooth;
  if (!is_curved || points.size() < 3) return std::nullopt;

  Curve best;
  double best_time = stopping_time(points, motion);
  const auto propose = [&](Curve curve) {
    const double slowdown = needed_slowdown(curve, motion);
    if (slowdown > 1.0 + limit_tolerance) curve = slowed(std::move(curve), slowdown);
    if (!verify(space, curve, clearance, clearance).is_verified) return false;
    if (duration(curve) < best_time) {
      best_time = duration(curve);
      best = std::move(curve);
    }
    return true;
  };
  const Curve blended = blend_corners(points, space, clearance, motion).curve;
  propose(blended);
  if (style == FlightStyle::smooth) {
    for (const double offset : wall_offsets) {
      if (propose(refine(blended, space, (1.0 + offset) * clearance, motion))) break;
    }
  }
  if (best.empty()) return std::nullopt;
  SmoothLeg leg{best, flight::length(best), best_time, energy(best, motion), 0.0};
  leg.clearance = verify(space, best, clearance, up_to).clearance;
  return leg;
}

}  // namespace skycap::flight
