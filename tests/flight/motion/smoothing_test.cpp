// Smoothed curves: closed-form results, limits, and no accepted curve that exact distances reject.
#include "flight/motion/smoothing.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/motion/corner_blend.h"
#include "flight/paths/path.h"
#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

const std::vector<Vector3d> right_angle{{0, 0, 10}, {20, 0, 10}, {20, 20, 10}};

Motion calm() { return Motion(Vehicle{}, Conditions{}); }

double stopping_time(const std::vector<Vector3d>& points, const Motion& motion) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += motion.leg_time(points[i] - points[i - 1]);
  return sum;
}

/// Returns free space with one ball of radius 0.1 m at each position.
KnownSpace air_with(const std::vector<Vector3d>& balls) {
  Obstacles obstacles;
  obstacles.cloud.radius = 0.1;
  for (const Vector3d& ball : balls) obstacles.cloud.points.push_back(ball.cast<float>());
  return KnownSpace(obstacles);
}

// Checks by dense sampling what the control points verify. 1e-6 allows for rounding.
void expect_flyable(const Curve& curve, const Motion& motion) {
  const Vehicle& vehicle = motion.vehicle();
  constexpr double dt = 1e-3;
  const double total = duration(curve);
  for (double t = 0.0; t <= total; t += 10 * dt) {
    const CurveState now = state_at(curve, t), next = state_at(curve, std::min(t + dt, total));
    const double speed = now.velocity.norm();
    const double top = speed > 0.0 ? motion.leg_speed(now.velocity / speed) : 0.0;
    ASSERT_LE(speed, top * (1 + 1e-6)) << t;
    ASSERT_LE(now.acceleration.head<2>().norm(), vehicle.mode.acceleration * (1 + 1e-6)) << t;
    ASSERT_LE(std::abs(now.acceleration.z()), vehicle.mode.vertical_acceleration * (1 + 1e-6)) << t;
    // The difference of accelerations is the mean jerk between them. A bounded mean jerk also means
    // that the acceleration is continuous.
    ASSERT_LE((next.acceleration - now.acceleration).norm(), dt * vehicle.mode.jerk * (1 + 1e-6))
        << t;
    // Position and velocity are consistent with the acceleration to the second order of the step.
    ASSERT_LE((next.velocity - now.velocity - dt * now.acceleration).norm(),
              dt * dt * vehicle.mode.jerk);
    ASSERT_LE((next.position - now.position - dt * now.velocity).norm(),
              dt * dt * vehicle.mode.acceleration);
  }
}

void expect_rest_at_ends(const Curve& curve, const Vector3d& from, const Vector3d& to) {
  const CurveState start = state_at(curve, 0.0), end = state_at(curve, duration(curve) - 1e-12);
  EXPECT_LT((start.position - from).norm(), 1e-9);
  EXPECT_LT((end.position - to).norm(), 1e-9);
  EXPECT_LT(start.velocity.norm() + start.acceleration.norm(), 1e-9);
  EXPECT_LT(end.velocity.norm() + end.acceleration.norm(), 1e-9);
}

// ---- curves ----------------------------------------------------------------------------------

// The quintic between the end states of a motion with constant jerk equals that motion.
TEST(Curve, MatchesCubicBetweenItsStates) {
  const Vector3d jerk(0.5, -1, 2);
  const auto cubic = [&](double t) -> CurveState {
    return {Vector3d(1, 2, 3) + t * Vector3d(1, 0, -1) + t * t * t / 6.0 * jerk,
            Vector3d(1, 0, -1) + t * t / 2.0 * jerk, t * jerk};
  };
  const Curve curve{segment_between(cubic(0.0), cubic(2.0), 2.0)};
  for (double t = 0.0; t < 2.0; t += 0.1) {
    EXPECT_LT((state_at(curve, t).position - cubic(t).position).norm(), 1e-12);
    EXPECT_LT((state_at(curve, t).velocity - cubic(t).velocity).norm(), 1e-12);
    EXPECT_LT((state_at(curve, t).acceleration - cubic(t).acceleration).norm(), 1e-11);
  }
}

// Peaks of a minimum-jerk motion over L = 10 m in T seconds: speed 15/8 of the mean, acceleration
// 10 / sqrt(3) L / T^2, jerk 60 L / T^3.
TEST(Curve, NeedsSlowdownOfMinimumJerkMotion) {
  const Motion motion = calm();
  const Curve curve{segment_between({Vector3d::Zero()}, {Vector3d(10, 0, 0)}, 1.0)};
  const double by_speed = 10.0 * 15.0 / 8.0 / motion.conditions().cruise_speed;
  const double by_acceleration =
      std::sqrt(100.0 / std::sqrt(3.0) / motion.vehicle().mode.acceleration);
  const double by_jerk = std::cbrt(600.0 / motion.vehicle().mode.jerk);
  const double min = std::max({by_speed, by_acceleration, by_jerk});
  const double bound = needed_slowdown(curve, motion);
  EXPECT_GE(bound, min * (1 - 1e-12));
  EXPECT_LE(bound, 1.05 * min);  // accuracy of the bound after two subdivisions
  EXPECT_LE(needed_slowdown(slowed(curve, bound), motion), 1.0 + 1e-12);
}

TEST(Curve, HasLengthOfLineAndOfArc) {
  EXPECT_NEAR(length({segment_between({Vector3d::Zero()}, {Vector3d(3, 4, 12)}, 5.0)}), 13.0, 1e-6);
  // A quarter circle of radius 4 m at 1 m/s is approximately a quintic between its end states.
  const double quarter = 2.0 * M_PI;
  const Curve arc{segment_between({Vector3d(4, 0, 0), Vector3d(0, 1, 0), Vector3d(-0.25, 0, 0)},
                                  {Vector3d(0, 4, 0), Vector3d(-1, 0, 0), Vector3d(0, -0.25, 0)},
                                  quarter)};
  EXPECT_NEAR(length(arc), quarter, 2e-3);
}

// The hull of the bend is 1 m deep, and an obstacle is inside it. Only subdivision can verify the
// curve.
TEST(Curve, IsVerifiedBySubdividingItsHull) {
  const Curve bend = blend_corners(right_angle, air_with({}), 1.0, calm()).curve;
  double nearest = 1e9;
  const Vector3d inside(18, 2, 10);
  for (double t = 0.0; t < duration(bend); t += 1e-3) {
    nearest = std::min(nearest, (state_at(bend, t).position - inside).norm() - 0.1);
  }
  const KnownSpace air = air_with({inside});
  EXPECT_TRUE(verify(air, bend, nearest - 1e-3).is_verified);
  EXPECT_FALSE(verify(air, bend, nearest + 1e-3).is_verified);
  EXPECT_LE(verify(air, bend, 0.5 * nearest).clearance, nearest);
}

// ---- blends ----------------------------------------------------------------------------------

TEST(Blend, IsShorterAndFasterInsideRightAngle) {
  const Motion motion = calm();
  const auto leg = smooth(right_angle, air_with({}), 1.0, 2.0, motion, FlightStyle::blend);
  ASSERT_TRUE(leg);
  EXPECT_LT(leg->length, 40.0);
  EXPECT_GT(leg->length, std::sqrt(2.0) * 20.0);
  EXPECT_LT(leg->duration, stopping_time(right_angle, motion) - 1.0);
  // Not faster than its length at full speed.
  EXPECT_GE(leg->duration, leg->length / motion.leg_speed(Vector3d::UnitX()));
  expect_flyable(leg->curve, motion);
  expect_rest_at_ends(leg->curve, right_angle.front(), right_angle.back());
  for (double t = 0.0; t < leg->duration; t += 0.01) {
    const Vector3d p = state_at(leg->curve, t).position;
    // Inside the triangle of the corner: between the legs and beyond the line between their ends.
    EXPECT_LE(p.x(), 20.0 + 1e-9);
    EXPECT_GE(p.y(), -1e-9);
    EXPECT_GE(p.x(), p.y() - 1e-9);
    EXPECT_NEAR(p.z(), 10.0, 1e-9);
  }
}

TEST(Blend, AvoidsObstacleInCornerOrStops) {
  const Motion motion = calm();
  const auto time = [&](const std::vector<Vector3d>& balls) {
    const auto leg = smooth(right_angle, air_with(balls), 1.0, 2.0, motion, FlightStyle::blend);
    return leg ? leg->duration : stopping_time(right_angle, motion);
  };
  const double open = time({});
  const double tight = time({{18.5, 1.5, 10}});
  // The obstacle is 1 m plus its radius away from both legs, 5 cm from the corner, which limits the
  // blend.
  const double blocked = time({{20 - 1.101, 1.101, 10}, {20 - 1.101, 0.05, 10 + 1.2}});
  EXPECT_LT(open, blocked - 0.1);
  EXPECT_LE(tight, blocked);
  EXPECT_LE(blocked, stopping_time(right_angle, motion));
}

TEST(Blend, KeepsLimitsOnVerticalLegsAndInWind) {
  Conditions windy;
  windy.wind = {-6.0, 3.0};
  const Motion motion(Vehicle{}, windy);
  const std::vector<Vector3d> stairs{{0, 0, 5},   {12, 0, 5}, {12, 0, 20}, {12, 9, 26},
                                     {30, 9, 26}, {30, 9, 8}, {31, 9, 8},  {4, 10, 8}};
  for (const FlightStyle style : {FlightStyle::blend, FlightStyle::smooth}) {
    const auto leg = smooth(stairs, air_with({}), 1.0, 2.0, motion, style);
    ASSERT_TRUE(leg);
    expect_flyable(leg->curve, motion);
    expect_rest_at_ends(leg->curve, stairs.front(), stairs.back());
  }
}

// ---- smoothing -------------------------------------------------------------------------------

TEST(Smooth, IsFasterThanBlend) {
  const Motion motion = calm();
  const std::vector<Vector3d> zigzag{
      {0, 0, 10}, {8, 3, 10}, {12, -3, 12}, {20, 0, 11}, {24, 9, 10}};
  const auto blend = smooth(zigzag, air_with({}), 1.0, 2.0, motion, FlightStyle::blend);
  const auto curve = smooth(zigzag, air_with({}), 1.0, 2.0, motion, FlightStyle::smooth);
  ASSERT_TRUE(blend && curve);
  EXPECT_LT(curve->duration, 0.95 * blend->duration);
  // No motion within the limits is faster than the straight line.
  const Vector3d displacement = zigzag.back() - zigzag.front(),
                 direction = displacement.normalized();
  EXPECT_GE(curve->duration,
            rest_to_rest_time(displacement.norm(), motion.leg_speed(direction),
                              motion.leg_acceleration(direction), motion.vehicle().mode.jerk) -
                1e-6);
  expect_flyable(curve->curve, motion);
  expect_rest_at_ends(curve->curve, zigzag.front(), zigzag.back());
}

TEST(Smooth, IsDeterministic) {
  const Motion motion = calm();
  const KnownSpace air = air_with({{15, 5, 10}});
  for (const FlightStyle style : {FlightStyle::blend, FlightStyle::smooth}) {
    const auto once = smooth(right_angle, air, 1.0, 2.0, motion, style);
    const auto again = smooth(right_angle, air, 1.0, 2.0, motion, style);
    ASSERT_TRUE(once && again);
    ASSERT_EQ(once->curve.size(), again->curve.size());
    for (std::size_t i = 0; i < once->curve.size(); ++i) {
      EXPECT_EQ(once->curve[i].duration, again->curve[i].duration);
      EXPECT_EQ(once->curve[i].control, again->curve[i].control);
    }
  }
}

TEST(Smooth, ReturnsNoCurveWithoutCorners) {
  const Motion motion = calm();
  const KnownSpace air = air_with({});
  EXPECT_FALSE(smooth(right_angle, air, 1.0, 2.0, motion, FlightStyle::stop));
  EXPECT_FALSE(smooth({{0, 0, 1}, {9, 0, 1}}, air, 1.0, 2.0, motion, FlightStyle::smooth));
  EXPECT_FALSE(
      smooth({{0, 0, 1}, {0, 0, 1}, {9, 0, 1}}, air, 1.0, 2.0, motion, FlightStyle::smooth));
  EXPECT_FALSE(smooth({}, air, 1.0, 2.0, motion, FlightStyle::blend));
}

// Random scenes: accepted curves keep their clearance at samples every 1 cm. With this spacing,
// nothing closer than the stated minimum clearance minus half a step could be missed.
TEST(Smooth, KeepsClearanceAtDenseSamplesOfRandomScenes) {
  std::mt19937_64 random(7);
  const Motion motion = calm();
  constexpr double clearance = 1.0;
  std::size_t accepted = 0, with_corners = 0;
  for (int scene = 0; scene < 4; ++scene) {
    Obstacles obstacles;
    obstacles.mesh = scene % 2 == 0 ? scenes::boxes(random, 60) : scenes::poles(random, 120);
    const KnownSpace space(obstacles);
    PathFinder finder(space, clearance);
    const Eigen::AlignedBox3d box(Vector3d(0, 0, 5), Vector3d(60, 60, 40));
    for (const Segment& displacement : scenes::legs(random, 8, box)) {
      const Path path = finder.find(displacement.from, displacement.to);
      if (path.status != PathStatus::found || path.points.size() < 3) continue;
      ++with_corners;
      const FlightStyle style = with_corners % 2 == 0 ? FlightStyle::blend : FlightStyle::smooth;
      const auto leg = smooth(path.points, space, clearance, 5.0, motion, style);
      if (!leg) continue;
      ++accepted;
      EXPECT_GE(leg->clearance, clearance);
      EXPECT_LT(leg->duration, stopping_time(path.points, motion));
      expect_flyable(leg->curve, motion);
      const double step = 0.01 / motion.conditions().cruise_speed;
      double nearest = 5.0;
      for (double t = 0.0; t < leg->duration; t += step) {
        nearest = std::min(nearest, space.distance(state_at(leg->curve, t).position, nearest));
      }
      EXPECT_GE(nearest, leg->clearance);
      EXPECT_GE(nearest, clearance);
    }
  }
  EXPECT_GE(with_corners, 8U);
  EXPECT_GE(2 * accepted, with_corners) << "most legs should gain something";
}

}  // namespace
}  // namespace skycap::flight
