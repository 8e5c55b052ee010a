#include "flight/motion/passage.h"

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
constexpr double most_cut_elsewhere = 3.0;
/// Minimum cut; corners that require a smaller one are stops [m].
constexpr double least_cut = 0.1;
/// Corners keep their shapes. They are moved outwards by the distance between curve and view until
/// it is below this limit [m], in a limited number of iterations. Each iteration reduces the
/// distance by a constant factor.
constexpr double near_enough = 1e-6;
constexpr int most_bendings = 40;
/// Minimum flight speed (see Motion::leg_speed()) [m/s].
constexpr double least_speed = 0.1;

double turn(double from, double to) { return std::remainder(to - from, 2.0 * std::numbers::pi); }

/// Returns the motion with its speed limited by image sharpness.
Motion slowed_for(const Motion& motion, const PassRules& rules) {
  Conditions conditions = motion.conditions();
  conditions.cruise_speed = std::min(conditions.cruise_speed, rules.speed);
  return {motion.vehicle(), conditions};
}

/// Path without repeated points, and the rules of the remaining points.
class Way {
 public:
  Way(const std::vector<Vector3d>& points, std::span<const ViewOnWay> views, const PassRules& rules)
      : views_(views) {
    std::vector<std::size_t> index(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (places_.empty() || points[i] != places_.back()) places_.push_back(points[i]);
      index[i] = places_.size() - 1;
    }
    points_ = places_;
    rules_.assign(points_.size(), {most_cut_elsewhere});
    for (const ViewOnWay& view : views) {
      point_of_.push_back(index[view.point]);
      if (places_of_views_.empty() || places_of_views_.back() != point_of_.back()) {
        places_of_views_.push_back(point_of_.back());
      }
      double& most_off = rules_[point_of_.back()].most_off;
      most_off = std::min(most_off, rules.most_cut);
    }
  }

  std::size_t size() const { return points_.size(); }
  /// Returns true if there is a view at either end of the path, where the vehicle cannot wait.
  bool has_view_at_end() const {
    return point_of_.front() == 0 || point_of_.back() + 1 == points_.size();
  }

  /// Rounds all corners with a curve through the view positions. Adds stops where the interval
  /// between two images is too short.
  BlendedWay blend(const FreeSpace& space, double clearance, const Motion& motion,
                   const PassRules& rules) {
    const auto lack = [&](const BlendedWay& way, std::size_t view) {
      const double time = way.moments[point_of_[view + 1]] - way.moments[point_of_[view]];
      return least_interval(views_[view].aim, views_[view + 1].aim, motion, rules) - time;
    };
    const auto bent = [&] { return bend(space, clearance, motion); };
    BlendedWay way = bent();
    for (std::size_t i = 0; i + 1 < views_.size(); ++i) {
      rules_[point_of_[i]].wait = 0.0;
      if (lack(way, i) > 0.0) rules_[point_of_[i]].most_off = 0.0;
    }
    // Stops only lengthen the other intervals.
    way = bent();
    waits_.assign(views_.size(), 0.0);
    for (std::size_t i = 0; i + 1 < views_.size(); ++i) {
      waits_[i] = std::max(0.0, lack(way, i));
      rules_[point_of_[i]].wait += waits_[i];
    }
    return blend_corners(points_, space, clearance, motion, rules_);
  }

  /// Reduces the cut at both ends of each piece that is not free. Returns true if all pieces are
  /// free, or if no cut can be reduced.
  bool relax(const BlendedWay& way, const std::function<bool(const Curve&)>& is_free) {
    std::vector<bool> is_tight(points_.size(), false);
    double begin = 0.0;
    for (const CurvePiece& piece : way.curve) {
      const double middle = begin + 0.5 * piece.duration;
      begin += piece.duration;
      if (is_free({piece})) continue;
      const auto next = std::ranges::upper_bound(way.moments, middle) - way.moments.begin();
      const auto end = std::min(static_cast<std::size_t>(next), points_.size() - 1);
      is_tight[end - 1] = is_tight[end] = true;
    }
    bool is_done = true;
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
      double& most_off = rules_[i].most_off;
      if (!is_tight[i] || most_off == 0.0) continue;
      most_off = most_off > 2.0 * least_cut ? 0.5 * most_off : 0.0;
      is_done = false;
    }
    return is_done;
  }

  /// Returns the capture times on the blended path. Images at the same position are consecutive.
  std::vector<double> moments(const BlendedWay& way) const {
    std::vector<double> moments;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const bool is_here = i > 0 && point_of_[i] == point_of_[i - 1];
      moments.push_back(is_here ? moments.back() + waits_[i - 1] : way.moments[point_of_[i]]);
    }
    return moments;
  }

 private:
  /// Moves corners until the curve passes through the view positions.
  BlendedWay bend(const FreeSpace& space, double clearance, const Motion& motion) {
    points_ = places_;
    for (CornerRule& rule : rules_) rule.shape.reset();
    BlendedWay way = blend_corners(points_, space, clearance, motion, rules_);
    for (int round = 0; round < most_bendings; ++round) {
      double most_off = 0.0;
      for (const std::size_t i : places_of_views_) {
        rules_[i].shape = way.shapes[i];  // A stop remains a stop.
        const Vector3d off = places_[i] - state_at(way.curve, way.moments[i]).position;
        points_[i] += off;
        most_off = std::max(most_off, off.norm());
      }
      if (most_off < near_enough) break;
      way = blend_corners(points_, space, clearance, motion, rules_);
    }
    return way;
  }

  std::span<const ViewOnWay> views_;
  std::vector<Vector3d> places_;              ///< Points without repetition.
  std::vector<Vector3d> points_;              ///< Displaced corners.
  std::vector<std::size_t> point_of_;         ///< Point index of each view.
  std::vector<std::size_t> places_of_views_;  ///< Distinct entries of `point_of_`.
  std::vector<CornerRule> rules_;             ///< One rule per point.
  std::vector<double> waits_;                 ///< Wait after each view [s].
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

double least_interval(const Aim& from, const Aim& to, const Motion& motion,
                      const PassRules& rules) {
  const MissionMode& mode = motion.vehicle().mode;
  const double turning = turn_time(turn(from.yaw, to.yaw), mode.yaw_rate, mode.yaw_acceleration);
  const double tilting = std::abs(to.pitch - from.pitch) / motion.vehicle().gimbal_rate;
  return std::max(rules.period,
                  std::max(turning, tilting) + 2.0 * std::max(settling, rules.exposure));
}

Aim Passage::aim_at(double time) const {
  const auto next = std::ranges::upper_bound(views, time, {}, &PassedView::moment);
  if (next == views.begin()) return views.front().aim;
  const PassedView& last = *(next - 1);
  if (next == views.end()) return last.aim;
  const double begin = last.moment + steady, end = next->moment - steady;
  const double share = std::clamp((time - begin) / (end - begin), 0.0, 1.0);
  return {last.aim.yaw + share * turn(last.aim.yaw, next->aim.yaw),
          last.aim.pitch + share * (next->aim.pitch - last.aim.pitch)};
}

std::optional<Passage> pass_through(const std::vector<Vector3d>& points,
                                    std::span<const ViewOnWay> views, const FreeSpace& space,
                                    double clearance, double up_to, const Motion& motion,
                                    const PassRules& rules,
                                    const std::function<bool(const Curve&)>& is_allowed) {
  if (views.empty() || !(rules.speed >= least_speed)) return std::nullopt;
  const Motion sharp = slowed_for(motion, rules);
  Way way(points, views, rules);
  if (way.size() < 3 || way.has_view_at_end()) return std::nullopt;
  const auto is_free = [&](const Curve& piece) {
    return prove(space, piece, clearance, clearance).is_proven &&
           (!is_allowed || is_allowed(piece));
  };
  BlendedWay blended = way.blend(space, clearance, sharp, rules);
  while (!way.relax(blended, is_free)) blended = way.blend(space, clearance, sharp, rules);
  const double slowdown = std::max(1.0, needed_slowdown(blended.curve, sharp));
  const double factor = slowdown > 1.0 + limit_tolerance ? slowdown : 1.0;

  Passage passage;
  passage.curve = slowed(blended.curve, factor);
  const LegProof proof = prove(space, passage.curve, clearance, up_to);
  if (!proof.is_proven) return std::nullopt;
  passage.clearance = proof.clearance;
  passage.steady = std::max(settling, rules.exposure);
  const std::vector<double> moments = way.moments(blended);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double moment = factor * moments[i];
    passage.views.push_back({moment, state_at(passage.curve, moment).position, views[i].aim});
  }
  passage.stops = stops_on(passage.curve);
  passage.length = flight::length(passage.curve);
  passage.duration = flight::duration(passage.curve);
  passage.energy = energy(passage.curve, sharp);
  return passage;
}

}  // namespace skycap::flight
