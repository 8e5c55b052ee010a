#include "flight/motion/corner_blend.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Maximum fraction of a straight piece that the blend at each end may use.
constexpr double max_piece_fraction = 0.45;
/// Factor by which a blend that violates the clearance is reduced, and the number of tries.
constexpr double shrinking = 0.8;
constexpr int max_tries = 14;
/// Minimum reach of a worthwhile blend [m].
constexpr double min_reach = 0.02;
/// Minimum distance between the first control points of a blend, relative to its reach.
constexpr double min_handle = 0.30;
/// Minimum duration of half a speed change and of constant speed [s]. Shorter pieces would have
/// inaccurate jerk.
constexpr double min_phase = 0.05;
/// Number of halvings in the search for a speed.
constexpr int bisections = 50;

/// Returns the largest value in [low, high] for which `holds` is true. `holds` must be true for low
/// and change at most once.
template <class Predicate>
double largest(double low, double high, const Predicate& holds) {
  if (holds(high)) return high;
  for (int i = 0; i < bisections; ++i) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

/// Speed change: rise, hold and fall of the acceleration.
struct Ramp {
  double rise = 0.0, hold = 0.0;  ///< Durations [s].

  double duration() const { return 2.0 * rise + hold; }
  Ramp stretched(double factor) const { return {factor * rise, factor * hold}; }
};

Ramp ramp(double from, double to, const MissionMode& limits) {
  const double change = std::abs(to - from);
  if (change == 0.0) return {};
  const double full_rise = limits.acceleration / limits.jerk;
  if (change >= limits.acceleration * full_rise) {
    const double hold = change / limits.acceleration - full_rise;
    if (hold >= min_phase && full_rise >= min_phase) return {full_rise, hold};
    // A short hold is merged into the rise, which reduces the jerk at the same peak.
    return {std::max(change / limits.acceleration, min_phase), 0.0};
  }
  return {std::max(std::sqrt(change / limits.jerk), min_phase), 0.0};
}

/// The ramp is symmetric, so its mean speed is that of its ends.
double ramp_distance(double from, double to, const MissionMode& limits) {
  return 0.5 * (from + to) * ramp(from, to, limits).duration();
}

/// Appends straight motion.
class StraightMotion {
 public:
  StraightMotion(Curve& curve, const Vector3d& start, const Vector3d& direction, double speed)
      : curve_(curve), direction_(direction), now_{start, speed * direction} {}

  void change_speed(double to, const Ramp& how) {
    if (how.rise == 0.0) return;
    const double from = now_.velocity.dot(direction_);
    const double peak = (to - from) / (how.rise + how.hold);
    advance(how.rise, 0.0, peak), advance(how.hold, peak, peak), advance(how.rise, peak, 0.0);
  }
  void hold_speed(double time) { advance(time, 0.0, 0.0); }

  /// Adds the rounding residual of the distance to the last piece.
  void end_in(const Vector3d& position) {
    CurveSegment& last = curve_.back();
    const Vector3d missing = position - last.control[5];
    for (std::size_t i = 3; i < 6; ++i) last.control[i] += missing;
  }

 private:
  void advance(double time, double from_acceleration, double to_acceleration) {
    if (time == 0.0) return;
    now_.acceleration = from_acceleration * direction_;
    CurveState next;
    next.acceleration = to_acceleration * direction_;
    next.velocity = now_.velocity + 0.5 * time * (now_.acceleration + next.acceleration);
    next.position = now_.position + time * now_.velocity +
                    time * time / 6.0 * (2.0 * now_.acceleration + next.acceleration);
    curve_.push_back(segment_between(now_, next, time));
    now_ = next;
  }

  Curve& curve_;
  Vector3d direction_;
  CurveState now_;
};

/// Passage of a corner. All zero: with a stop.
struct Blend : CornerShape {
  double speed = 0.0;  ///< At both ends [m/s].
};

class Blender {
 public:
  Blender(const std::vector<Vector3d>& points, const FreeSpace& space, double clearance,
          const Motion& motion, std::span<const CornerRule> rules)
      : points_(points),
        space_(space),
        clearance_(clearance),
        motion_(motion),
        rules_(rules.begin(), rules.end()) {
    rules_.resize(points.size());
  }

  BlendedPath blend() {
    blends_.resize(points_.size());
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) blends_[i] = largest_blend(i);
    match_speeds();
    BlendedPath path{{}, {0.0}, {blends_.begin(), blends_.end()}};
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
      if (i > 0) pass(i, path);
      add_straight(i, path.curve);
    }
    path.moments.push_back(duration(path.curve));
    return path;
  }

 private:
  Vector3d direction(std::size_t i) const { return (points_[i + 1] - points_[i]).normalized(); }
  double segment_length(std::size_t i) const { return (points_[i + 1] - points_[i]).norm(); }
  double straight_length(std::size_t i) const {
    return segment_length(i) - blends_[i].reach - blends_[i + 1].reach;
  }

  /// Returns control points on both arms of the corner. They are evenly spaced, which gives
  /// constant speed and zero acceleration at the ends.
  CurveSegment blend_segment(std::size_t corner, const Blend& blend) const {
    const Vector3d before = direction(corner - 1), after = direction(corner);
    const double step = blend.handle * blend.reach;
    const Vector3d start = points_[corner] - blend.reach * before;
    const Vector3d end = points_[corner] + blend.reach * after;
    return {{start, start + step * before, start + 2.0 * step * before, end - 2.0 * step * after,
             end - step * after, end},
            5.0 * step / blend.speed};
  }

  /// Returns the blend of that reach with the fastest handle.
  Blend fastest_blend(std::size_t corner, double reach) const {
    constexpr int tries = 11;
    double handle = min_handle;
    Blend best;
    for (int i = 0; i < tries; ++i, handle += 0.02) {
      const Blend blend = make_blend(corner, {reach, std::min(handle, 0.5)});
      if (blend.speed > best.speed) best = blend;
    }
    return best;
  }

  Blend make_blend(std::size_t corner, const CornerShape& shape) const {
    Blend blend{shape, 1.0};
    // At 1 m/s it may be sped up by the inverse of its required slowdown.
    blend.speed = 1.0 / needed_slowdown({blend_segment(corner, blend)}, motion_);
    return blend;
  }

  bool is_verified(std::size_t corner, const Blend& blend) const {
    return verify(space_, {blend_segment(corner, blend)}, clearance_, clearance_).is_verified;
  }

  /// Appends the corner: the blend, or a stop in it.
  void pass(std::size_t corner, BlendedPath& path) const {
    const double now = duration(path.curve);
    const double wait = rules_[corner].wait;
    if (blends_[corner].reach > 0.0) {
      path.curve.push_back(blend_segment(corner, blends_[corner]));
      path.moments.push_back(now + 0.5 * path.curve.back().duration);
      return;
    }
    path.moments.push_back(now);
    if (wait > 0.0)
      path.curve.push_back(segment_between({points_[corner]}, {points_[corner]}, wait));
  }

  /// Returns the maximum reach of a blend that observes the rule's maximum distance, for the
  /// roundest shape. With the handle h, the middle of the piece is (16 - 25 h) / 32 of its reach
  /// away, along both arms.
  double allowed_reach(std::size_t corner) const {
    const double bend = (direction(corner) - direction(corner - 1)).norm();
    const double off = (16.0 - 25.0 * min_handle) / 32.0 * bend;
    const double reach = longest_reach(corner);
    return off * reach > rules_[corner].max_offset ? rules_[corner].max_offset / off : reach;
  }

  double longest_reach(std::size_t corner) const {
    return max_piece_fraction * std::min(segment_length(corner - 1), segment_length(corner));
  }

  Blend largest_blend(std::size_t corner) const {
    // Near a reversal, the triangle degenerates to a line and a stop at its end is required.
    if (direction(corner - 1).dot(direction(corner)) < -0.95) return {};
    if (rules_[corner].max_offset == 0.0) return {};
    if (std::optional<CornerShape> shape = rules_[corner].shape) {
      shape->reach = std::min(shape->reach, longest_reach(corner));
      if (shape->reach < min_reach) return {};
      const Blend blend = make_blend(corner, *shape);
      return is_verified(corner, blend) ? blend : Blend{};
    }
    double reach = allowed_reach(corner);
    for (int i = 0; i < max_tries && reach > min_reach; ++i, reach *= shrinking) {
      const Blend blend = fastest_blend(corner, reach);
      if (is_verified(corner, blend)) return blend;
    }
    return {};
  }

  /// Reduces the speeds at corners, forwards and backwards, until each can be reached from the
  /// previous one within the straight piece between them.
  void match_speeds() {
    const MissionMode& limits = motion_.vehicle().mode;
    const auto limit = [&](std::size_t from, std::size_t to, std::size_t segment) {
      const double start = blends_[from].speed, available_length = straight_length(segment);
      double& speed = blends_[to].speed;
      if (speed <= start) return;
      speed = largest(start, speed, [&](double v) {
        return ramp_distance(start, v, limits) <= available_length;
      });
    };
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) limit(i, i + 1, i);
    for (std::size_t i = points_.size() - 1; i > 0; --i) limit(i, i - 1, i - 1);
  }

  void add_straight(std::size_t i, Curve& curve) const {
    const MissionMode& limits = motion_.vehicle().mode;
    const Vector3d path = direction(i);
    const double start = blends_[i].speed, end = blends_[i + 1].speed,
                 available_length = straight_length(i);
    StraightMotion motion(curve, points_[i] + blends_[i].reach * path, path, start);
    const auto needed = [&](double peak) {
      return ramp_distance(start, peak, limits) + ramp_distance(peak, end, limits) +
             min_phase * peak;
    };
    const double min = std::max(start, end), max = std::max(min, motion_.leg_speed(path));
    if (needed(min) <= available_length) {
      const double peak =
          largest(min, max, [&](double v) { return needed(v) <= available_length; });
      motion.change_speed(peak, ramp(start, peak, limits));
      motion.hold_speed(min_phase + (available_length - needed(peak)) / peak);
      motion.change_speed(end, ramp(peak, end, limits));
    } else if (start == end) {
      motion.hold_speed(available_length / start);
    } else {  // One ramp, stretched to the available length.
      const double factor = available_length / ramp_distance(start, end, limits);
      motion.change_speed(end, ramp(start, end, limits).stretched(factor));
    }
    motion.end_in(points_[i + 1] - blends_[i + 1].reach * path);
  }

  const std::vector<Vector3d>& points_;
  const FreeSpace& space_;
  double clearance_;
  const Motion& motion_;
  std::vector<CornerRule> rules_;
  std::vector<Blend> blends_;  ///< One per point, zero at the ends.
};

}  // namespace

BlendedPath blend_corners(const std::vector<Vector3d>& points, const FreeSpace& space,
                          double clearance, const Motion& motion,
                          std::span<const CornerRule> rules) {
  return Blender(points, space, clearance, motion, rules).blend();
}

}  // namespace skycap::flight
