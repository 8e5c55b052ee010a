#include "flight/fleet/separation.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double jerk = 5.0;

/// Returns a leg with up to `speed`, the duration of the seven-phase motion, and a wait.
ScriptedLeg leg_between(const Vector3d& from, const Vector3d& to, double speed, double wait) {
  const double acceleration = 2.0;
  return {.from = from,
          .to = to,
          .moving = rest_to_rest_time((to - from).norm(), speed, acceleration, jerk),
          .wait = wait,
          .speed = speed,
          .acceleration = acceleration};
}

Vector3d position_at(const TimedFlight& flight, double time) {
  double begin = flight.start;
  for (const ScriptedLeg& leg : flight.script) {
    if (time <= begin + leg.duration()) return set_point(leg, flight.jerk, time - begin).position;
    begin += leg.duration();
  }
  return flight.script.back().to;
}

/// Returns the minimum distance of positions sampled every `step`, within the time tolerance of
/// both flights.
double sampled(const TimedFlight& first, const TimedFlight& second, double tolerance, double step) {
  double min_distance = 1e9;
  for (double t = first.start; t <= first.landing(); t += step) {
    const Vector3d position = position_at(first, t);
    const double from = std::max(second.start, t - 2.0 * tolerance);
    const double to = std::min(second.landing(), t + 2.0 * tolerance);
    for (double u = from; u <= to; u += step) {
      min_distance = std::min(min_distance, (position - position_at(second, u)).norm());
    }
  }
  return min_distance;
}

TEST(Separation, IsZeroForHeadOnAndGapForParallelFlights) {
  const TimedFlight there{{leg_between({0, 0, 10}, {40, 0, 10}, 4.0, 1.0)}, jerk, 0.0};
  const TimedFlight back{{leg_between({40, 0, 10}, {0, 0, 10}, 4.0, 1.0)}, jerk, 0.0};
  const TimedFlight beside{{leg_between({0, 7, 10}, {40, 7, 10}, 4.0, 1.0)}, jerk, 0.0};
  EXPECT_NEAR(verified_distance(there, back, 0.0, 100.0), 0.0, 1e-9);
  EXPECT_TRUE(too_near(there, back, {.distance = 1.0}));
  EXPECT_NEAR(verified_distance(there, beside, 0.0, 100.0), 7.0, 2e-3);
  EXPECT_LE(verified_distance(there, beside, 0.0, 100.0), 7.0);
  EXPECT_FALSE(too_near(there, beside, {.distance = 6.99}));
  EXPECT_TRUE(too_near(there, beside, {.distance = 7.01}));
}

// One flight crosses the other's path later. The flights are far apart on schedule, but may meet if
// both are delayed.
TEST(Separation, DecreasesWithTimeTolerance) {
  const TimedFlight first{{leg_between({-20, 0, 10}, {20, 0, 10}, 4.0, 0.0)}, jerk, 0.0};
  const TimedFlight second{{leg_between({0, -20, 10}, {0, 20, 10}, 4.0, 0.0)}, jerk, 8.0};
  // Both cross in the middle of their flights, 8 s apart.
  EXPECT_GT(verified_distance(first, second, 0.0, 100.0), 10.0);
  double before = 1e9;
  for (const double tolerance : {0.0, 1.0, 2.0, 3.0, 3.9}) {
    const double distance = verified_distance(first, second, tolerance, 100.0);
    EXPECT_LT(distance, before);
    before = distance;
  }
  EXPECT_NEAR(verified_distance(first, second, 4.0, 100.0), 0.0, 1e-3);
}

TEST(Separation, IsNotRequiredAfterLandingPlusTolerance) {
  const TimedFlight first{{leg_between({0, 0, 10}, {20, 0, 10}, 4.0, 0.0)}, jerk, 0.0};
  TimedFlight second = first;
  second.start = first.landing() + 10.1;
  EXPECT_FALSE(too_near(first, second, {.distance = 50.0, .tolerance = 5.0}));
  second.start = first.landing() + 9.9;
  EXPECT_TRUE(too_near(first, second, {.distance = 50.0, .tolerance = 5.0}));
}

TEST(Separation, ReportsEncounterPositions) {
  const TimedFlight first{{leg_between({0, 0, 10}, {40, 0, 10}, 4.0, 0.0)}, jerk, 0.0};
  const TimedFlight second{{leg_between({20, 3, 10}, {20, 3, 10}, 4.0, 100.0)}, jerk, 0.0};
  const auto encounter = too_near(first, second, {.distance = 5.0});
  ASSERT_TRUE(encounter);
  EXPECT_LT(encounter->distance, 5.0);
  EXPECT_NEAR((encounter->first - encounter->second).norm(), encounter->distance, 1e-9);
  EXPECT_NEAR((encounter->first - position_at(first, encounter->time)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((encounter->second - Vector3d(20, 3, 10)).norm(), 0.0, 1e-9);
}

// 100,000 random pairs of timed legs. No sample contradicts a verified separation, each rejected
// pair is too close, and the bound equals the sampled distance within the sampling error.
TEST(Separation, IsNotMoreThanSampledDistanceOfRandomLegs) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(40, 40, 20));
  const auto random_flight = [&] {
    const Vector3d from = scenes::point_in(random, box), to = scenes::point_in(random, box);
    const double speed = 1.0 + 9.0 * uniform(random), wait = 2.0 * uniform(random);
    return TimedFlight{{leg_between(from, to, speed, wait)}, jerk, 5.0 * uniform(random)};
  };
  int verified = 0;
  for (int i = 0; i < 100'000; ++i) {
    const TimedFlight first = random_flight(), second = random_flight();
    const double tolerance = i % 4 == 0 ? 0.5 * uniform(random) : 0.0;
    const double step = tolerance > 0.0 ? 0.25 : 0.05;
    const double min_distance = sampled(first, second, tolerance, step);
    const SeparationRule rule{5.0 + 10.0 * uniform(random), tolerance};
    const auto encounter = too_near(first, second, rule);
    if (!encounter) {
      ++verified;
      ASSERT_GE(min_distance, rule.distance) << "pair " << i;
    } else {
      ASSERT_LT(encounter->distance, rule.distance + 1e-5) << "pair " << i;
    }
    if (i % 10 != 0) continue;
    const double bound = verified_distance(first, second, tolerance, 200.0);
    ASSERT_LE(bound, min_distance + 1e-9) << "pair " << i;
    if (min_distance > 1e8) continue;  // both fly at the same time for less than one step, or never
    // The closest positions are at most one step from a sample, at up to 10 m/s for each flight.
    ASSERT_GE(bound, std::min(200.0, min_distance) - 2.0 * 10.0 * step - 2e-3) << "pair " << i;
  }
  EXPECT_GT(verified, 30'000);
  EXPECT_LT(verified, 90'000);
}

TEST(Separation, IsComputedFromGroundPointToWholeFlight) {
  const FlightScript script{leg_between({0, 0, 0}, {0, 0, 8}, 2.0, 0.0),
                            leg_between({0, 0, 8}, {30, 0, 8}, 4.0, 0.0)};
  EXPECT_NEAR(distance_from(script, {15, 6, 0}), 10.0, 1e-9);
}

}  // namespace
}  // namespace skycap::flight
