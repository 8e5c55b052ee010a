#include "flight/motion/fly_through.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flight/motion/corner_blend.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Estimated time from the end of a rotation until the camera is at rest [s].
constexpr double settling = 0.2;
/// Maximum cut of a corner without a view [m]. A larger cut saves little, and a curve close to the
/// planned path is more likely to have returns.
constexpr double max_cut_elsewhere = 3.0;
/// Minimum cut; corners that require a smaller one are stops [m].
constexpr double min_cut = 0.1;
/// Corners keep their shapes. They are moved outwards by the distance between curve and view until
/// it is below this limit [m], in a limited number of iterations. Each iteration reduces the
/// distance by a constant factor.
constexpr double near_enough = 1e-6;
constexpr int max_bends = 40;
/// Minimum flight speed (see Motion::leg_speed()) [m/s].
constexpr double min_speed = 0.1;

double turn(double from, double to) { return std::remainder(to - from, 2.0 * std::numbers::pi); }

/// Returns the motion with its speed limited by image sharpness.
Motion slowed_for(const Motion& motion, const PassRules& rules) {
  Conditions conditions = motion.conditions();
  conditions.cruise_speed = std::min(conditions.cruise_speed, rules.speed);
  return {motion.vehicle(), conditions};
}

/// Path without repeated points, and the rules of the remaining points.
class FlyThroughPath {
 public:
  FlyThroughPath(const std::vector<Vector3d>& points, std::span<const FlyThroughView> views,
                 const PassRules& rules)
      : views_(views) {
    std::vector<std::size_t> index(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (positions_.empty() || points[i] != positions_.back()) positions_.push_back(points[i]);
      index[i] = positions_.size() - 1;
    }
    points_ = positions_;
    rules_.assign(points_.size(), {max_cut_elsewhere});
    for (const FlyThroughView& view : views) {
      point_indices_.push_back(index[view.point]);
      if (view_points_.empty() || view_points_.back() != point_indices_.back()) {
        view_points_.push_back(point_indices_.back());
      }
      double& max_offset = rules_[point_indices_.back()].max_offset;
      max_offset = std::min(max_offset, rules.max_cut);
    }
  }

  std::size_t size() const { return points_.size(); }
  /// Returns true if there is a view at either end of the path, where the vehicle cannot wait.
  bool has_view_at_end() const {
    return point_indices_.front() == 0 || point_indices_.back() + 1 == points_.size();
  }

  /// Rounds all corners with a curve through the view positions. Adds stops where the interval
  /// between two images is too short.
  BlendedPath blend(const FreeSpace& space, double clearance, const Motion& motion,
                    const PassRules& rules) {
    const auto lack = [&](const BlendedPath& path, std::size_t view) {
      const double time =
          path.moments[point_indices_[view + 1]] - path.moments[point_indices_[view]];
      return min_interval(views_[view].aim, views_[view + 1].aim, motion, rules) - time;
    };
    const auto bent = [&] { return bend(space, clearance, motion); };
    BlendedPath path = bent();
    for (std::size_t i = 0; i + 1 < views_.size(); ++i) {
      rules_[point_indices_[i]].wait = 0.0;
      if (lack(path, i) > 0.0) rules_[point_indices_[i]].max_offset = 0.0;
    }
    // Stops only lengthen the other intervals.
    path = bent();
    waits_.assign(views_.size(), 0.0);
    for (std::size_t i = 0; i + 1 < views_.size(); ++i) {
      waits_[i] = std::max(0.0, lack(path, i));
      rules_[point_indices_[i]].wait += waits_[i];
    }
    return blend_corners(points_, space, clearance, motion, rules_);
  }

  /// Reduces the cut at both ends of each piece that is not free. Returns true if all pieces are
  /// free, or if no cut can be reduced.
  bool relax(const BlendedPath& path, const std::function<bool(const Curve&)>& is_free) {
    std::vector<bool> is_tight(points_.size(), false);
    double begin = 0.0;
    for (const CurveSegment& segment : path.curve) {
      const double middle = begin + 0.5 * segment.duration;
      begin += segment.duration;
      if (is_free({segment})) continue;
      const auto next = std::ranges::upper_bound(path.moments, middle) - path.moments.begin();
      const auto end = std::min(static_cast<std::size_t>(next), points_.size() - 1);
      is_tight[end - 1] = is_tight[end] = true;
    }
    bool is_done = true;
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
      double& max_offset = rules_[i].max_offset;
      if (!is_tight[i] || max_offset == 0.0) continue;
      max_offset = max_offset > 2.0 * min_cut ? 0.5 * max_offset : 0.0;
      is_done = false;
    }
    return is_done;
  }

  /// Returns the capture times on the blended path. Images at the same position are consecutive.
  std::vector<double> moments(const BlendedPath& path) const {
    std::vector<double> moments;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const bool is_here = i > 0 && point_indices_[i] == point_indices_[i - 1];
      moments.push_back(is_here ? moments.back() + waits_[i - 1] : path.moments[point_indices_[i]]);
    }
    return moments;
  }

 private:
  /// Moves corners until the curve passes through the view positions.
  BlendedPath bend(const FreeSpace& space, double clearance, const Motion& motion) {
    points_ = positions_;
    for (CornerRule& rule : rules_) rule.shape.reset();
    BlendedPath path = blend_corners(points_, space, clearance, motion, rules_);
    for (int round = 0; round < max_bends; ++round) {
      double max_offset = 0.0;
      for (const std::size_t i : view_points_) {
        rules_[i].shape = path.shapes[i];  // A stop remains a stop.
        const Vector3d off = positions_[i] - state_at(path.curve, path.moments[i]).position;
        points_[i] += off;
        max_offset = std::max(max_offset, off.norm());
      }
      if (max_offset < near_enough) break;
      path = blend_corners(points_, space, clearance, motion, rules_);
    }
    return path;
  }

  std::span<const FlyThroughView> views_;
  std::vector<Vector3d> positions_;         ///< Points without repetition.
  std::vector<Vector3d> points_;            ///< Displaced corners.
  std::vector<std::size_t> point_indices_;  ///< Point index of each view.
  std::vector<std::size_t> view_points_;    ///< Distinct entries of `point_indices_`.
  std::vector<CornerRule> rules_;           ///< One rule per point.
  std::vector<double> waits_;               ///< Wait after each view [s].
};

/// Returns the number of positions between the ends of a curve at which it is at rest.
std::size_t stops_on(const Curve& curve) {
  std::size_t stops = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const auto& control = curve[i].control;
    const bool begins_at_rest = control[0] == control[1];
    const bool is_wait = begins_at_rest && control[0] == control[5];
    if (begins_at_rest && !is_wait) ++stops;
  }
  return stops;
}

}  // namespace

double min_interval(const Aim& from, const Aim& to, const Motion& motion, const PassRules& rules) {
  const MissionMode& mode = motion.vehicle().mode;
  const double turning = turn_time(turn(from.yaw, to.yaw), mode.yaw_rate, mode.yaw_acceleration);
  const double tilting = std::abs(to.pitch - from.pitch) / motion.vehicle().gimbal_rate;
  return std::max(rules.period,
                  std::max(turning, tilting) + 2.0 * std::max(settling, rules.exposure));
}

Aim FlyThrough::aim_at(double time) const {
  const auto next = std::ranges::upper_bound(views, time, {}, &PassedView::moment);
  if (next == views.begin()) return views.front().aim;
  const PassedView& last = *(next - 1);
  if (next == views.end()) return last.aim;
  const double begin = last.moment + steady, end = next->moment - steady;
  const double share = std::clamp((time - begin) / (end - begin), 0.0, 1.0);
  return {last.aim.yaw + share * turn(last.aim.yaw, next->aim.yaw),
          last.aim.pitch + share * (next->aim.pitch - last.aim.pitch)};
}

std::optional<FlyThrough> pass_through(const std::vector<Vector3d>& points,
                                       std::span<const FlyThroughView> views,
                                       const FreeSpace& space, double clearance, double up_to,
                                       const Motion& motion, const PassRules& rules,
                                       const std::function<bool(const Curve&)>& is_allowed) {
  if (views.empty() || !(rules.speed >= min_speed)) return std::nullopt;
  const Motion sharp = slowed_for(motion, rules);
  FlyThroughPath path(points, views, rules);
  if (path.size() < 3 || path.has_view_at_end()) return std::nullopt;
  const auto is_free = [&](const Curve& segment) {
    return verify(space, segment, clearance, clearance).is_verified &&
           (!is_allowed || is_allowed(segment));
  };
  BlendedPath blended = path.blend(space, clearance, sharp, rules);
  while (!path.relax(blended, is_free)) blended = path.blend(space, clearance, sharp, rules);
  const double slowdown = std::max(1.0, needed_slowdown(blended.curve, sharp));
  const double factor = slowdown > 1.0 + limit_tolerance ? slowdown : 1.0;

  FlyThrough fly_through;
  fly_through.curve = slowed(blended.curve, factor);
  const LegVerification verification = verify(space, fly_through.curve, clearance, up_to);
  if (!verification.is_verified) return std::nullopt;
  fly_through.clearance = verification.clearance;
  fly_through.steady = std::max(settling, rules.exposure);
  const std::vector<double> moments = path.moments(blended);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double moment = factor * moments[i];
    fly_through.views.push_back(
        {moment, state_at(fly_through.curve, moment).position, views[i].aim});
  }
  fly_through.stops = stops_on(fly_through.curve);
  fly_through.length = flight::length(fly_through.curve);
  fly_through.duration = flight::duration(fly_through.curve);
  fly_through.energy = energy(fly_through.curve, sharp);
  return fly_through;
}

}  // namespace skycap::flight
