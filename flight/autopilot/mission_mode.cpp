#include "flight/autopilot/mission_mode.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "geometry/requirement.h"

namespace skycap::flight {
namespace {

/// Returns the largest value in [0, most] for which the increasing function `of` is at most
/// `bound`.
template <typename Function>
double largest_below(double max, double bound, Function of) {
  if (of(max) <= bound) return max;
  double low = 0.0, high = max;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (of(middle) <= bound ? low : high) = middle;
  }
  return low;
}

/// Returns the positive root v of v (v / a + k) = b.
double speed_for(double b, double a, double k) {
  return 0.5 * a * (std::sqrt(k * k + 4.0 * b / a) - k);
}

/// Returns the time from rest to `speed` with zero acceleration at both ends, in phases of constant
/// jerk [s].
double ramp_time(double speed, double acceleration, double jerk) {
  if (speed * jerk >= acceleration * acceleration)
    return acceleration / jerk + speed / acceleration;
  return 2.0 * std::sqrt(speed / jerk);
}

/// Returns the duration of a leg that is too short for the full jerk [s]. Only the rise of the jerk
/// is limited, to `snap` [m/s^4]. All four rises take the same time.
double short_s_curve_time(double distance, const LegLimits& limits, double snap) {
  using std::numbers::pi;
  const double by_distance = std::pow(pi * distance / (16.0 * snap), 0.25);
  const double by_speed = std::cbrt(pi * limits.speed / (4.0 * snap));
  const double by_acceleration = std::sqrt(pi * limits.acceleration / (2.0 * snap));
  const double rise = std::min({by_distance, by_speed, by_acceleration});
  if (rise == by_distance) return 8.0 * rise;
  const double acceleration = 2.0 * snap * rise * rise / pi;
  double speed = 2.0 * acceleration * rise;
  if (rise != by_speed) {  // The acceleration remains constant for some time.
    speed = std::min(limits.speed, speed_for(distance, acceleration, 2.0 * rise));
  }
  return distance / speed + speed / acceleration + 2.0 * rise;
}

}  // namespace

double s_curve_time(double distance, const LegLimits& limits, double jerk, double jerk_rise) {
  if (distance <= 0.0) return 0.0;
  // The rise to the acceleration a and the fall to zero take a / jerk + jerk_rise each.
  const auto half_ramp = [&](double a) { return a / jerk + jerk_rise; };
  const double for_speed =
      largest_below(limits.acceleration, limits.speed, [&](double a) { return a * half_ramp(a); });
  const double acceleration = largest_below(
      for_speed, distance, [&](double a) { return 2.0 * a * half_ramp(a) * half_ramp(a); });
  if (acceleration < jerk * jerk_rise) {
    return short_s_curve_time(distance, limits, 0.5 * jerk * std::numbers::pi / jerk_rise);
  }
  const double half = half_ramp(acceleration);
  if (acceleration < for_speed) return 4.0 * half;  // The leg consists only of ramps.
  const double speed = acceleration < limits.acceleration
                           ? acceleration * half
                           : std::min(limits.speed, speed_for(distance, acceleration, half));
  return distance / speed + speed / acceleration + half;
}

double braking_distance_time(double distance, const LegLimits& limits, double jerk) {
  const double a = limits.acceleration, b = 4.0 * a * a / jerk;
  const double left = acceptance_radius;
  if (distance <= left) return 0.0;
  const double last_speed = 0.5 * (std::sqrt(b * b + 8.0 * a * left) - b);
  const auto ramp_distance = [&](double v) { return 0.5 * v * ramp_time(v, a, jerk); };
  const auto braking_distance = [&](double v) {
    return std::max(0.0, v * (v + b) / (2.0 * a) - left);
  };
  const double travelled = distance - left;
  const double speed = largest_below(
      limits.speed, travelled, [&](double v) { return ramp_distance(v) + braking_distance(v); });
  const double cruise = std::max(0.0, travelled - ramp_distance(speed) - braking_distance(speed));
  double time = ramp_time(speed, a, jerk) + cruise / speed;
  if (speed > last_speed) {  // dt = -dd / v along the speed law.
    time += (speed - last_speed) / a + b / (2.0 * a) * std::log(speed / last_speed);
  }
  return time;
}

double braking_distance(const MissionMode& mode, double speed) {
  // Linear up to the speed at which proportional control with a gain of 1/s reaches the maximum
  // acceleration, then with this acceleration.
  const double a = mode.acceleration;
  return speed < a ? speed : 0.5 * a + speed * speed / (2.0 * a);
}

double return_overshoot(const MissionMode& mode) {
  const double a = mode.acceleration, j = mode.jerk;
  // The S-curve ends with a ramp of constant jerk, on which speed v remains for v / 3 sqrt(2 v /
  // j). The difference to the braking distance is largest at v = 2 j, or above the ramp if it ends
  // below that speed.
  return a >= 2.0 * j ? 2.0 / 3.0 * j : 0.5 * a - a * a * a / (24.0 * j * j);
}

void MissionMode::validate(const std::string& owner) const {
  const auto require = [&](bool holds, const std::string& field, double value,
                           const std::string& right) {
    skycap::require(holds && std::isfinite(value), "vehicle \"" + owner + "\": " + field, value,
                    right);
  };
  const auto positive = [&](double value, const std::string& field) {
    require(value > 0.0, field, value, "positive");
  };
  const auto not_negative = [&](double value, const std::string& field) {
    require(value >= 0.0, field, value, "zero or more");
  };
  positive(max_ascent, "max_ascent"), positive(max_descent, "max_descent");
  positive(acceleration, "acceleration");
  positive(vertical_acceleration, "vertical_acceleration"), positive(jerk, "jerk");
  not_negative(jerk_rise, "jerk_rise"), not_negative(settle_time, "settle_time");
  positive(yaw_rate, "yaw_rate"), positive(yaw_acceleration, "yaw_acceleration");
  positive(takeoff_speed, "takeoff_speed"), not_negative(takeoff_ramp, "takeoff_ramp");
  positive(landing_speed, "landing_speed"), not_negative(landing_height, "landing_height");
  not_negative(touchdown_time, "touchdown_time");
}

}  // namespace skycap::flight
