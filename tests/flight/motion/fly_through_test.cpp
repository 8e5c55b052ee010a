// Fly-through capture: closed-form results, limits, steady cameras, and curves through the view
// positions.
#include "flight/motion/fly_through.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/clearance.h"
#include "flight/clearance/obstacles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

Motion calm() { return Motion(Vehicle{}, Conditions{}); }

KnownSpace open_air() { return KnownSpace(Obstacles{}); }

constexpr PassRules easy{.speed = 100.0, .max_cut = 1.0, .exposure = 0.001, .period = 1.0};

/// Square path of 40 m around the origin. The views at its corners look at the centre.
struct Round {
  std::vector<Vector3d> points{{-30, -20, 10}, {-20, -20, 10}, {20, -20, 10},
                               {20, 20, 10},   {-20, 20, 10},  {-30, 20, 10}};
  std::vector<FlyThroughView> views;

  Round() {
    for (std::size_t i = 1; i < 5; ++i) {
      views.push_back({i, {std::atan2(-points[i].x(), -points[i].y()), -0.3}});
    }
  }
};

std::optional<FlyThrough> pass(const Round& round, const PassRules& rules, const Motion& motion) {
  return pass_through(round.points, round.views, open_air(), 1.0, 2.0, motion, rules);
}

TEST(FlyThrough, PassesSquareWithoutStops) {
  const Round round;
  const Motion motion = calm();
  const auto fly_through = pass(round, easy, motion);
  ASSERT_TRUE(fly_through);
  EXPECT_EQ(fly_through->stops, 0U);
  ASSERT_EQ(fly_through->views.size(), 4U);
  double stopping = 0.0, straight = 0.0;
  for (std::size_t i = 1; i < round.points.size(); ++i) {
    const Vector3d displacement = round.points[i] - round.points[i - 1];
    stopping += motion.leg_time(displacement), straight += displacement.norm();
  }
  EXPECT_LT(fly_through->duration, stopping - 4.0);
  EXPECT_GT(fly_through->duration, fly_through->length / motion.leg_speed(Vector3d::UnitX()));
  EXPECT_LT(fly_through->length, straight + 4.0 * easy.max_cut);
  for (std::size_t i = 0; i < 4; ++i) {
    const PassedView& view = fly_through->views[i];
    EXPECT_LT((view.position - round.points[i + 1]).norm(), 0.01) << "through its place";
    // By symmetry, the vehicle crosses the bisector of the corner perpendicularly.
    const Vector3d velocity = state_at(fly_through->curve, view.moment).velocity;
    EXPECT_GT(velocity.norm(), 0.5);
    const Vector3d across = (round.points[i + 2] - round.points[i + 1]).normalized() +
                            (round.points[i + 1] - round.points[i]).normalized();
    EXPECT_NEAR(velocity.normalized().dot(across.normalized()), 1.0, 0.01);
  }
}

// The exposure lasts so long that the image would move by more than one pixel above 2 m/s. The
// speed limit applies over 12.5 m.
TEST(FlyThrough, KeepsSharpImageSpeed) {
  PassRules slow = easy;
  slow.speed = 2.0;
  const auto fly_through = pass(Round(), slow, calm());
  ASSERT_TRUE(fly_through);
  for (double t = 0.0; t < fly_through->duration; t += 0.01) {
    ASSERT_LE(state_at(fly_through->curve, t).velocity.norm(), 2.0 + 1e-6) << t;
  }
  EXPECT_FALSE(pass(Round(), {.speed = 0.0, .max_cut = 1.0}, calm())) << "never sharp";
  EXPECT_FALSE(pass(Round(), {.speed = 0.09, .max_cut = 1.0}, calm())) << "nothing flies so slowly";
}

// The camera turns by 90° between corners within its rate limit, and stands still during each
// capture.
TEST(FlyThrough, TurnsCameraOnlyBetweenCaptures) {
  const Motion motion = calm();
  PassRules long_exposure = easy;
  long_exposure.exposure = 0.5;
  const auto fly_through = pass(Round(), long_exposure, motion);
  ASSERT_TRUE(fly_through);
  EXPECT_GE(fly_through->steady, 0.5);
  for (const PassedView& view : fly_through->views) {
    for (const double beside : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const Aim aim = fly_through->aim_at(view.moment + beside);
      EXPECT_NEAR(std::remainder(aim.yaw - view.aim.yaw, 2.0 * M_PI), 0.0, 1e-9);
      EXPECT_NEAR(aim.pitch, view.aim.pitch, 1e-9);
    }
  }
  for (double t = 0.0; t < fly_through->duration; t += 0.01) {
    const double turned =
        std::remainder(fly_through->aim_at(t + 0.01).yaw - fly_through->aim_at(t).yaw, 2.0 * M_PI);
    ASSERT_LE(std::abs(turned), 0.01 * motion.vehicle().mode.yaw_rate + 1e-9) << t;
  }
}

// Two views 2 m apart look in opposite directions. Half a second of flight is too short for this
// rotation.
TEST(FlyThrough, StopsWhereCameraCannotTurnInTime) {
  const std::vector<Vector3d> points{{0, 0, 10}, {30, 0, 10}, {32, 0, 10}, {60, 0, 10}};
  const std::vector<FlyThroughView> views{{1, {0.0, 0.0}}, {2, {M_PI, 0.0}}};
  const Motion motion = calm();
  const auto fly_through = pass_through(points, views, open_air(), 1.0, 2.0, motion, easy);
  ASSERT_TRUE(fly_through);
  EXPECT_EQ(fly_through->stops, 1U);
  const double between = fly_through->views[1].moment - fly_through->views[0].moment;
  EXPECT_GE(between, min_interval(views[0].aim, views[1].aim, motion, easy) - 1e-9);
  EXPECT_LT((fly_through->views[0].position - points[1]).norm(), 1e-9);
}

TEST(FlyThrough, CapturesSeveralViewsAtOnePosition) {
  const std::vector<Vector3d> points{{0, 0, 10}, {30, 0, 10}, {30, 30, 10}};
  const std::vector<FlyThroughView> views{{1, {0.0, 0.0}}, {1, {1.0, 0.0}}, {1, {2.0, 0.5}}};
  const Motion motion = calm();
  const auto fly_through = pass_through(points, views, open_air(), 1.0, 2.0, motion, easy);
  ASSERT_TRUE(fly_through);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((fly_through->views[i].position - points[1]).norm(), 1e-9);
    EXPECT_NEAR(fly_through->aim_at(fly_through->views[i].moment).yaw, views[i].aim.yaw, 1e-9);
    if (i == 0) continue;
    EXPECT_NEAR(fly_through->views[i].moment - fly_through->views[i - 1].moment,
                min_interval(views[i - 1].aim, views[i].aim, motion, easy), 1e-9);
  }
}

// A ball inside the corner, whose clearance touches both legs: the corner is not cut.
TEST(FlyThrough, KeepsClearanceFromObstacleInsideCorner) {
  Obstacles obstacles;
  obstacles.cloud.radius = 0.1;
  obstacles.cloud.points.push_back({18.89F, -18.89F, 10.0F});
  const KnownSpace space(obstacles);
  const Round round;
  const auto free = pass(round, easy, calm());
  const auto tight = pass_through(round.points, round.views, space, 1.0, 2.0, calm(), easy);
  ASSERT_TRUE(free && tight);
  EXPECT_GE(tight->clearance, 1.0);
  EXPECT_GE(tight->duration, free->duration);
  for (double t = 0.0; t < tight->duration; t += 0.005) {
    const Vector3d position = state_at(tight->curve, t).position;
    ASSERT_GE((position - Vector3d(18.89, -18.89, 10.0)).norm() - 0.1, 1.0 - 1e-5) << t;
  }
}

TEST(FlyThrough, ReturnsNoFlightWithoutViews) {
  const Round round;
  EXPECT_FALSE(pass_through(round.points, {}, open_air(), 1.0, 2.0, calm(), easy));
  const std::vector<FlyThroughView> at_end{{5, {}}};
  EXPECT_FALSE(pass_through(round.points, at_end, open_air(), 1.0, 2.0, calm(), easy));
}

}  // namespace
}  // namespace skycap::flight
