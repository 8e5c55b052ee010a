#include "flight/motion/passage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flight/motion/corner_blend.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// From the end of a turn until the camera has come to rest [s]; an estimate.
constexpr double settling = 0.2;
/// A corner of the way without a view may be cut by this much [m]: more saves little, and the
/// nearer a curve is to the way that was planned, the rather it has ways home.
constexpr double most_cut_elsewhere = 3.0;
/// Corners that would have to be cut by less are stopped in [m].
constexpr double least_cut = 0.1;
/// Corners keep their shapes and are moved outwards by what the curve is off their views, until
/// that is no more than this [m], but not more often than that: each time it is a share of what it
/// was.
constexpr double near_enough = 1e-6;
constexpr int most_bendings = 40;
/// Nothing is flown more slowly (see Motion::leg_speed()) [m/s].
constexpr double least_speed = 0.1;

double turn(double from, double to) { return std::remainder(to - from, 2.0 * std::numbers::pi); }

/// The same motion, no faster than pictures stay sharp.
Motion slowed_for(const Motion& motion, const PassRules& rules) {
  Conditions conditions = motion.conditions();
  conditions.cruise_speed = std::min(conditions.cruise_speed, rules.speed);
  return {motion.vehicle(), conditions};
}

/// A way without repeated points, and what is asked of the points that are left.
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
  /// Where the way begins or ends nobody can wait.
  bool has_view_at_end() const {
    return point_of_.front() == 0 || point_of_.back() + 1 == points_.size();
  }

  /// Round all corners but through the places of views, with stops where the time between two
  /// pictures would not do.
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
    // Stops only lengthen the time between others.
    way = bent();
    waits_.assign(views_.size(), 0.0);
    for (std::size_t i = 0; i + 1 < views_.size(); ++i) {
      waits_[i] = std::max(0.0, lack(way, i));
      rules_[point_of_[i]].wait += waits_[i];
    }
    return blend_corners(points_, space, clearance, motion, rules_);
  }

  /// Cuts the corners at both ends of each piece less that is not free. Whether all are, or nothing
  /// is left to cut less.
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

  /// When the pictures are taken on the way that was blended: those of one place one after the
  /// other.
  std::vector<double> moments(const BlendedWay& way) const {
    std::vector<double> moments;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const bool is_here = i > 0 && point_of_[i] == point_of_[i - 1];
      moments.push_back(is_here ? moments.back() + waits_[i - 1] : way.moments[point_of_[i]]);
    }
    return moments;
  }

 private:
  /// Moves corners until the curve leads through the places of views.
  BlendedWay bend(const FreeSpace& space, double clearance, const Motion& motion) {
    points_ = places_;
    for (CornerRule& rule : rules_) rule.shape.reset();
    BlendedWay way = blend_corners(points_, space, clearance, motion, rules_);
    for (int round = 0; round < most_bendings; ++round) {
      double most_off = 0.0;
      for (const std::size_t i : places_of_views_) {
        rules_[i].shape = way.shapes[i];  // a stop stays one
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
  std::vector<Vector3d> places_;              ///< the points, each once
  std::vector<Vector3d> points_;              ///< corners that the curve is bent round
  std::vector<std::size_t> point_of_;         ///< for each view
  std::vector<std::size_t> places_of_views_;  ///< the same, each once
  std::vector<CornerRule> rules_;             ///< for each point
  std::vector<double> waits_;                 ///< after each view
};

/// Places between its ends at which a curve is at rest.
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
