#include "flight/motion/curve.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using Control = std::array<Vector3d, 6>;

/// Number of halvings after which a part that cannot be verified counts as too close. A piece of
/// 100 m then has parts of 2 cm, which deviate from their chords by at most 1e-5 m.
constexpr int max_halvings = 12;
/// Number of halvings for bounds on derivatives. Two give bounds within some percent of the
/// minimum.
constexpr int derivative_halvings = 2;
/// Hull radius below which a hull equals its chord: clearance_guard covers the difference.
constexpr double thin = 1e-9;
/// Number of halvings for the length. Each reduces the error by a factor of 16.
constexpr int length_halvings = 4;
/// Number of integration steps for the energy of a piece.
constexpr int integral_steps = 16;

/// De Casteljau subdivision at one half.
std::array<Control, 2> halves(Control points) {
  std::array<Control, 2> parts;
  for (std::size_t level = 0; level < 6; ++level) {
    parts[0][level] = points[0];
    parts[1][5 - level] = points[5 - level];
    for (std::size_t i = 0; i + 1 < 6 - level; ++i) points[i] = 0.5 * (points[i] + points[i + 1]);
  }
  return parts;
}

CurveState compute_state(const CurveSegment& segment, double share) {
  // The levels of de Casteljau's algorithm contain the points of the derivatives, too.
  Control points = segment.control;
  const auto lower = [&](std::size_t count) {
    for (std::size_t i = 0; i + 1 < count; ++i) {
      points[i] = (1.0 - share) * points[i] + share * points[i + 1];
    }
  };
  lower(6), lower(5), lower(4);
  CurveState state;
  const double rate = 1.0 / segment.duration;
  state.acceleration = 20.0 * rate * rate * (points[2] - 2.0 * points[1] + points[0]);
  lower(3);
  state.velocity = 5.0 * rate * (points[1] - points[0]);
  lower(2);
  state.position = points[0];
  return state;
}

/// Returns a weighted mean of the lengths of chord and control polygon. Source: Gravesen, Adaptive
/// Subdivision and the Length and Energy of Bezier Curves, 1997, with the weights for degree 5.
double compute_length(const Control& control, int halvings) {
  if (halvings > 0) {
    double sum = 0.0;
    for (const Control& half : halves(control)) sum += compute_length(half, halvings - 1);
    return sum;
  }
  double polygon = 0.0;
  for (std::size_t i = 0; i < 5; ++i) polygon += (control[i + 1] - control[i]).norm();
  return ((control[5] - control[0]).norm() + 2.0 * polygon) / 3.0;
}

/// Returns the maximum distance of a hull from its chord [m].
double hull_radius(const Control& control) {
  const Segment chord{control.front(), control.back()};
  double squared = 0.0;
  for (std::size_t i = 1; i < 5; ++i) {
    squared = std::max(squared, nearest(chord, control[i]).squared_distance);
  }
  const double radius = std::sqrt(squared);
  return radius < thin ? 0.0 : radius;
}

LegVerification verify_part(const FreeSpace& space, const Control& control, double clearance,
                            double up_to, int halvings_left) {
  // The points within a radius of a chord form a convex set. If it contains the control points, it
  // also contains the curve. The curve's clearance is therefore at least that of the chord minus
  // the radius.
  const double radius = hull_radius(control);
  const LegVerification chord =
      verify(space, {control.front(), control.back()}, clearance + radius, up_to + radius);
  if (chord.is_verified) return {true, chord.clearance - radius, chord.closest};
  // The curve passes within the radius of every point of the chord. If the chord violates the
  // clearance by more than that, so does the curve, and subdivision cannot help.
  const bool is_hopeless = chord.clearance + radius < clearance || radius == 0.0;
  if (is_hopeless || halvings_left == 0) return {false, 0.0, chord.closest};
  LegVerification verification{true, up_to, {up_to}};
  for (const Control& half : halves(control)) {
    LegVerification part = verify_part(space, half, clearance, up_to, halvings_left - 1);
    if (!part.is_verified) return part;
    if (part.clearance < verification.clearance) verification = part;
  }
  return verification;
}

double compute_segment_slowdown(const Control& c, double duration, const Motion& motion,
                                int halvings) {
  if (halvings > 0) {
    double factor = 0.0;
    for (const Control& half : halves(c)) {
      factor =
          std::max(factor, compute_segment_slowdown(half, 0.5 * duration, motion, halvings - 1));
    }
    return factor;
  }
  const double rate = 1.0 / duration;
  double factor = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    const Vector3d velocity = 5.0 * rate * (c[i + 1] - c[i]);
    const double speed = velocity.norm();
    if (speed > 0.0) factor = std::max(factor, speed / motion.leg_speed(velocity / speed));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d acceleration = 20.0 * rate * rate * (c[i + 2] - 2.0 * c[i + 1] + c[i]);
    const double size = acceleration.norm();
    if (size > 0.0) {
      factor = std::max(factor, std::sqrt(size / motion.leg_acceleration(acceleration / size)));
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d jerk =
        60.0 * rate * rate * rate * (c[i + 3] - 3.0 * c[i + 2] + 3.0 * c[i + 1] - c[i]);
    factor = std::max(factor, std::cbrt(jerk.norm() / motion.vehicle().mode.jerk));
  }
  return factor;
}

}  // namespace

// Matches position, velocity and acceleration at both ends.
CurveSegment segment_between(const CurveState& from, const CurveState& to, double duration) {
  const double first = duration / 5.0, second = duration * duration / 20.0;
  CurveSegment segment;
  segment.duration = duration;
  segment.control[0] = from.position;
  segment.control[1] = from.position + first * from.velocity;
  segment.control[2] = from.position + 2.0 * first * from.velocity + second * from.acceleration;
  segment.control[3] = to.position - 2.0 * first * to.velocity + second * to.acceleration;
  segment.control[4] = to.position - first * to.velocity;
  segment.control[5] = to.position;
  return segment;
}

std::array<CurveSegment, 2> halves(const CurveSegment& segment) {
  const std::array<Control, 2> parts = halves(segment.control);
  return {CurveSegment{parts[0], 0.5 * segment.duration},
          CurveSegment{parts[1], 0.5 * segment.duration}};
}

double hull_radius(const CurveSegment& segment) { return hull_radius(segment.control); }

double duration(const Curve& curve) {
  double sum = 0.0;
  for (const CurveSegment& segment : curve) sum += segment.duration;
  return sum;
}

double length(const Curve& curve) {
  double sum = 0.0;
  for (const CurveSegment& segment : curve) sum += compute_length(segment.control, length_halvings);
  return sum;
}

CurveState state_at(const Curve& curve, double time) {
  for (const CurveSegment& segment : curve) {
    if (time < segment.duration)
      return compute_state(segment, std::max(0.0, time / segment.duration));
    time -= segment.duration;
  }
  return {curve.back().control.back()};
}

Curve slowed(Curve curve, double factor) {
  for (CurveSegment& segment : curve) segment.duration *= factor;
  return curve;
}

double needed_slowdown(const Curve& curve, const Motion& motion) {
  double factor = 0.0;
  for (const CurveSegment& segment : curve) {
    factor = std::max(factor, compute_segment_slowdown(segment.control, segment.duration, motion,
                                                       derivative_halvings));
  }
  return factor;
}

LegVerification verify(const FreeSpace& space, const Curve& curve, double clearance, double up_to) {
  LegVerification verification{true, up_to, {up_to}};
  for (const CurveSegment& segment : curve) {
    LegVerification part = verify_part(space, segment.control, clearance, up_to, max_halvings);
    if (!part.is_verified) return part;
    if (part.clearance < verification.clearance) verification = part;
  }
  return verification;
}

double energy(const Curve& curve, const Motion& motion) {
  double sum = 0.0, peak_speed = 0.0;
  for (const CurveSegment& segment : curve) {
    const double step = segment.duration / integral_steps;
    for (int i = 0; i < integral_steps; ++i) {  // Midpoint rule.
      const Vector3d velocity = compute_state(segment, (i + 0.5) / integral_steps).velocity;
      sum += step * motion.flight_power(velocity);
      peak_speed = std::max(peak_speed, velocity.norm());
    }
  }
  return sum + motion.stopping_energy(peak_speed);
}

}  // namespace skycap::flight
