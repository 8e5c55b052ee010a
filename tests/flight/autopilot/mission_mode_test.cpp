#include "flight/autopilot/mission_mode.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/motion/motion.h"
#include "geometry/error.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

// ---- numerical reference: integrates the jerk and finds the phases by search ------------------

constexpr int steps = 4000;

struct Covered {
  double time = 0.0, distance = 0.0, speed = 0.0;
};

/// Accelerates from rest. The jerk rises as a raised cosine in `rise` to `jerk`, stays constant and
/// falls again. After a phase of constant acceleration, the jerk does the same with opposite sign.
Covered speed_up(double jerk, double rise, double jerk_hold, double acceleration_hold) {
  const double block = 2.0 * rise + jerk_hold;
  Covered state{2.0 * block + acceleration_hold};
  const auto block_jerk = [&](double t) {
    if (t < rise) return 0.5 * jerk * (1.0 - std::cos(std::numbers::pi * t / rise));
    if (t < rise + jerk_hold) return jerk;
    return 0.5 * jerk * (1.0 - std::cos(std::numbers::pi * (block - t) / rise));
  };
  const double dt = state.time / steps;
  double acceleration = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) * dt;
    double now = 0.0;
    if (t < block) now = block_jerk(t);
    if (t > block + acceleration_hold) now = -block_jerk(t - block - acceleration_hold);
    const double middle = acceleration + 0.5 * now * dt;
    acceleration += now * dt;
    state.distance += dt * (state.speed + 0.5 * middle * dt);
    state.speed += middle * dt;
  }
  return state;
}

double largest_that(double max, const std::function<bool(double)>& holds) {
  if (holds(max)) return max;
  double low = 0.0, high = max;
  for (int i = 0; i < 40; ++i) (holds(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  return low;
}

/// Computes the closed form in s_curve_time() numerically.
double integrated_s_curve(double distance, const LegLimits& limits, double jerk, double jerk_rise) {
  const auto fits = [&](const Covered& state) {
    return state.speed <= limits.speed && 2.0 * state.distance <= distance;
  };
  // First the jerk rise, whose slope is fixed, then the constant jerk, then the constant
  // acceleration.
  const double share = largest_that(1.0, [&](double s) {
    return s * s * jerk * jerk_rise <= limits.acceleration &&
           fits(speed_up(s * jerk, s * jerk_rise, 0.0, 0.0));
  });
  const double peak_jerk = share * jerk, rise = share * jerk_rise;
  double jerk_hold = 0.0;
  if (share == 1.0) {
    jerk_hold = largest_that(limits.acceleration / jerk - rise, [&](double hold) {
      return fits(speed_up(peak_jerk, rise, hold, 0.0));
    });
  }
  const double acceleration_hold = largest_that(
      100.0, [&](double hold) { return fits(speed_up(peak_jerk, rise, jerk_hold, hold)); });
  const Covered ramp = speed_up(peak_jerk, rise, jerk_hold, acceleration_hold);
  return 2.0 * ramp.time + std::max(0.0, distance - 2.0 * ramp.distance) / ramp.speed;
}

TEST(SCurve, MatchesNumericalIntegration) {
  for (const double distance : {0.02, 0.3, 1.0, 4.0, 15.0, 60.0, 300.0}) {
    for (const double speed : {0.1, 1.5, 4.0, 12.0}) {
      for (const double acceleration : {0.2, 1.0, 2.5}) {
        const LegLimits limits{speed, acceleration};
        const double time = s_curve_time(distance, limits, 1.0, 0.3);
        EXPECT_NEAR(time, integrated_s_curve(distance, limits, 1.0, 0.3), 2e-3 * time)
            << distance << " m, " << speed << " m/s, " << acceleration << " m/s^2";
      }
    }
  }
}

// With a jerk rise time of zero, the motion has seven phases, whose duration has another closed
// form.
TEST(SCurve, MatchesSevenPhasesWithoutJerkRiseTime) {
  for (const double distance : {0.01, 0.5, 3.0, 20.0, 200.0}) {
    for (const double speed : {0.5, 4.0, 15.0}) {
      EXPECT_NEAR(s_curve_time(distance, {speed, 2.0}, 4.0, 0.0),
                  rest_to_rest_time(distance, speed, 2.0, 4.0), 1e-9)
          << distance << " m at " << speed << " m/s";
    }
  }
}

TEST(SCurve, MatchesClosedFormOnLongLegs) {
  EXPECT_NEAR(s_curve_time(100.0, {4.0, 1.6}, 1.0, 0.3), 25.0 + 2.5 + 1.6 + 0.3, 1e-9);
  EXPECT_EQ(s_curve_time(0.0, {4.0, 2.5}, 1.0, 0.3), 0.0);
}

// ---- PX4 braking law --------------------------------------------------------------------------

/// Integrates in time steps: jerk-limited acceleration, then the speed that the remaining distance
/// allows.
double stepped_braking(double distance, const LegLimits& limits, double jerk) {
  const double a = limits.acceleration, b = 4.0 * a * a / jerk, dt = 2e-5;
  double gone = 0.0, time = 0.0;
  const auto allowed = [&] {
    const double left = distance - gone;
    return std::min(limits.speed, 0.5 * (std::sqrt(b * b + 8.0 * a * left) - b));
  };
  // The peak speed is where the two meet. The search finds the largest target speed whose ramp
  // still meets the braking law.
  const auto ramp_to = [&](double target, double t) {
    return rest_to_rest_state(1e9, target, a, jerk, t);
  };
  const double target = largest_that(limits.speed, [&](double v) {
    const double ramp = v * jerk >= a * a ? a / jerk + v / a : 2.0 * std::sqrt(v / jerk);
    gone = ramp_to(v, ramp).distance;
    return gone < distance && allowed() >= v;
  });
  const double ramp =
      target * jerk >= a * a ? a / jerk + target / a : 2.0 * std::sqrt(target / jerk);
  gone = ramp_to(target, ramp).distance;
  for (time = ramp; distance - gone > acceptance_radius; time += dt) {
    gone += dt * std::min(target, allowed());
  }
  return time;
}

TEST(BrakingDistance, MatchesNumericalIntegration) {
  for (const double distance : {2.0, 5.0, 20.0, 100.0}) {
    for (const LegLimits& limits : {LegLimits{4.0, 3.0}, LegLimits{1.5, 3.0}}) {
      const double time = braking_distance_time(distance, limits, 4.0);
      EXPECT_NEAR(time, stepped_braking(distance, limits, 4.0), 1e-3 * time) << distance;
    }
  }
  EXPECT_EQ(braking_distance_time(0.9 * acceptance_radius, {4.0, 3.0}, 4.0), 0.0);
}

// ---- simulated flights ------------------------------------------------------------------------

struct Hop {
  double horizontal, vertical;
};
struct LoggedSortie {
  double seconds;  ///< in ArduCopter's simulator, from take-off to disarming
  std::vector<Hop> hops;
};

/// Returns three sorties in the ArduCopter 4.8 simulator at 4 m/s with default parameters. Each
/// starts 5 m above the pad, stops for 1 s at each waypoint, and lands from 5 m.
const std::vector<LoggedSortie>& logged_sorties() {
  static const std::vector<LoggedSortie> sorties{
      {191.0,
       {{27.38, -2.99},
        {8.80, 0.00},
        {14.93, 0.00},
        {6.17, 3.07},
        {3.96, 6.77},
        {24.78, -9.84},
        {18.06, 11.24},
        {8.85, 3.00},
        {10.06, 8.21},
        {16.74, 11.88},
        {1.29, 14.10},
        {51.97, -34.73},
        {8.71, -1.01},
        {1.66, 2.11},
        {12.41, 0.70},
        {24.17, -12.50}}},
      {327.0, {{21.04, 15.35}, {1.73, 15.09},  {3.96, 2.29},    {0.51, 0.05},   {18.07, 14.84},
               {35.05, 9.61},  {6.31, 16.58},  {13.94, -16.98}, {23.24, -9.68}, {22.85, -24.76},
               {6.47, 0.40},   {1.15, -11.63}, {7.36, -14.16},  {9.21, 0.00},   {32.34, 0.73},
               {10.04, 21.11}, {18.90, -4.30}, {9.96, 10.41},   {4.87, -11.45}, {13.81, -0.71},
               {0.03, -0.86},  {0.44, 0.34},   {2.73, 0.46},    {0.37, -0.43},  {1.27, 2.25},
               {0.68, -0.10},  {3.40, -13.24}, {12.93, 10.46},  {0.54, 0.30},   {48.24, -11.97}}},
      {108.0,
       {{47.34, 22.15},
        {4.80, 9.23},
        {20.16, -12.98},
        {8.15, -3.40},
        {2.38, -2.53},
        {0.08, -0.58},
        {3.60, 3.09},
        {2.52, -3.91},
        {1.48, -2.41},
        {24.38, -8.68}}}};
  return sorties;
}

// Requirement: within 5% of the logged times.
TEST(ArduCopter, PredictsLoggedFlightTimesWithinFivePercent) {
  const Motion motion(vehicle_profile("generic_ardupilot"), {.cruise_speed = 4.0});
  for (const LoggedSortie& sortie : logged_sorties()) {
    double time = motion.takeoff_time(5.0) + motion.landing_time(5.0);
    for (const Hop& hop : sortie.hops) {
      time += motion.leg_time({hop.horizontal, 0.0, hop.vertical}) + 1.0;
    }
    EXPECT_NEAR(time, sortie.seconds, 0.05 * sortie.seconds);
    RecordProperty("predicted_over_flown", std::to_string(time / sortie.seconds));
  }
}

/// Returns the maximum of the braking distance minus the distance left on the final ramps of an
/// S-curve that brakes from 20 m/s, by numerical integration backwards from the stop.
double integrated_overshoot(double acceleration, double jerk) {
  constexpr double step = 1e-4;
  MissionMode mode;
  mode.acceleration = acceleration;
  double speed = 0.0, left = 0.0, most = 0.0;
  for (double time = 0.0; speed < 20.0; time += step) {
    left += speed * step;
    speed += std::min(acceleration, jerk * time) * step;
    most = std::max(most, braking_distance(mode, speed) - left);
  }
  return most;
}

TEST(ArduCopter, PassesStopsWhenAReturnBegins) {
  MissionMode mode;
  mode.acceleration = 2.5;
  EXPECT_DOUBLE_EQ(braking_distance(mode, 2.0), 2.0);
  EXPECT_DOUBLE_EQ(braking_distance(mode, 4.0), 1.25 + 3.2);
  for (const auto& [acceleration, jerk] :
       {std::pair{2.5, 1.0}, {3.0, 6.0}, {1.0, 1.0}, {5.0, 2.5}, {2.0, 20.0}}) {
    mode.acceleration = acceleration, mode.jerk = jerk;
    EXPECT_NEAR(return_overshoot(mode), integrated_overshoot(acceleration, jerk), 0.01)
        << acceleration << ' ' << jerk;
  }
}

TEST(MissionMode, RejectsZeroLandingSpeed) {
  MissionMode mode;
  mode.landing_speed = 0.0;
  try {
    mode.validate("kite");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("vehicle \"kite\": landing_speed is 0"));
  }
}

}  // namespace
}  // namespace skycap::flight
