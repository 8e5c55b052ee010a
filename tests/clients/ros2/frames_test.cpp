#include "clients/ros2/frames.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "clients/ros2/pose_history.h"
#include "tests/clients/ros2/sample_messages.h"
#include "tests/support/complaint.h"

namespace skycap::ros2 {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing_support::thrown_message;

constexpr double rounding = 1e-12;
constexpr double right_angle = std::numbers::pi / 2;

/// The body is rotated by 90° to the left and faces north. The sensor is 0.5 m in front of it and
/// 0.2 m below.
TEST(Mount, AlignsOpticalFrameWithREP103) {
  const Mount mount(parse_extrinsic("0.5 0 -0.2 0 0 0 1", ""), Axes::flu);
  const BodyPose body{.position = {10, 20, 30},
                      .turn = Quaterniond(AngleAxisd(right_angle, Vector3d::UnitZ())),
                      .covariance = {}};
  const Isometry3d world_from_optical = mount.world_from_optical(body);
  const auto expect_direction = [&](const Vector3d& optical, const Vector3d& world) {
    EXPECT_NEAR((world_from_optical.linear() * optical - world).norm(), 0.0, rounding);
  };
  EXPECT_NEAR((world_from_optical.translation() - Vector3d(10, 20.5, 29.8)).norm(), 0.0, 1e-9);
  expect_direction(Vector3d::UnitZ(), Vector3d::UnitY());   // forward is north
  expect_direction(Vector3d::UnitX(), Vector3d::UnitX());   // right is east
  expect_direction(Vector3d::UnitY(), -Vector3d::UnitZ());  // down is -z
  const Isometry3d back = mount.world_from_body(world_from_optical);
  EXPECT_NEAR((back.translation() - body.position).norm(), 0.0, 1e-9);
  EXPECT_NEAR((back.linear() - body.turn.toRotationMatrix()).norm(), 0.0, rounding);
}

/// Camera transform as usually published in ROS: "0 0 0 -0.5 0.5 -0.5 0.5".
TEST(Mount, UsesOpticalFrameUnchanged) {
  const Isometry3d optical =
      Mount(parse_extrinsic("0 0 0 -0.5 0.5 -0.5 0.5", ""), Axes::optical).world_from_optical({});
  const Isometry3d flu =
      Mount(parse_extrinsic("0 0 0 0 0 0 1", ""), Axes::flu).world_from_optical({});
  EXPECT_NEAR((optical.matrix() - flu.matrix()).norm(), 0.0, rounding);
}

/// Compares with a Monte Carlo simulation: sampled errors of the body and the resulting sensor
/// positions.
TEST(Mount, TransformsCovarianceLikeSampledErrors) {
  const Mount mount(parse_extrinsic("2 -1 0.5 0 0 0 1", ""), Axes::flu);
  BodyPose body{.position = {1, 2, 3},
                .turn = Quaterniond(AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())),
                .covariance = {}};
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, 1e-4);
  const Covariance spread = Covariance::NullaryExpr([&] { return normal(random); });
  body.covariance = spread * spread.transpose();
  const Isometry3d sensor = mount.world_from_optical(body);
  Covariance sum = Covariance::Zero();
  constexpr int draws = 200'000;
  std::normal_distribution<double> unit;
  for (int i = 0; i < draws; ++i) {
    Eigen::Matrix<double, 6, 1> noise;
    for (double& value : noise) value = unit(random);
    const Eigen::Matrix<double, 6, 1> error = spread * noise;
    const Vector3d turn = error.tail<3>();
    BodyPose moved = body;
    moved.position += error.head<3>();
    moved.turn = Quaterniond(AngleAxisd(turn.norm(), turn.normalized())) * body.turn;
    Eigen::Matrix<double, 6, 1> at_sensor;
    at_sensor << mount.world_from_optical(moved).translation() - sensor.translation(), turn;
    sum += at_sensor * at_sensor.transpose();
  }
  const Covariance drawn = sum / draws;
  // With 200,000 samples, the standard deviation of the variances is 0.3%.
  EXPECT_LT((drawn - mount.covariance_at_sensor(body).value()).norm(), 0.02 * drawn.norm());
  body.covariance.reset();
  EXPECT_FALSE(mount.covariance_at_sensor(body));
}

TEST(BodyPose, RejectsInvalidPoses) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto error_message = [](const auto& corrupt) {
    SampleOdometry odometry(seconds(1.0), {1, 2, 3});
    corrupt(odometry.message.pose);
    return thrown_message([&] { body_pose(odometry.message); });
  };
  EXPECT_EQ(error_message([](auto&) {}), "");
  EXPECT_THAT(error_message([](auto& p) { p.pose.position.z = none; }), HasSubstr("position"));
  EXPECT_THAT(error_message([](auto& p) { p.pose.orientation.x = none; }), HasSubstr("quaternion"));
  EXPECT_THAT(error_message([](auto& p) { p.pose.orientation.w = 0; }), HasSubstr("quaternion"));
  EXPECT_THAT(error_message([](auto& p) { p.pose.orientation.w = 1.02; }), HasSubstr("quaternion"));
  EXPECT_THAT(error_message([](auto& p) { p.covariance[7] = none; }), HasSubstr("is not finite"));
  EXPECT_THAT(error_message([](auto& p) { p.covariance[0] = -1; }), HasSubstr("negative variance"));
  EXPECT_THAT(error_message([](auto& p) { p.covariance[1] = 1; }), HasSubstr("not symmetric"));
}

TEST(BodyPose, HasNoCovarianceWhenMatrixIsZero) {
  SampleOdometry odometry(seconds(1.0), {1, 2, 3});
  EXPECT_FALSE(body_pose(odometry.message).covariance);
  odometry.message.pose.covariance[0] = 0.25;
  EXPECT_EQ(body_pose(odometry.message).covariance.value()(0, 0), 0.25);
}

TEST(Extrinsic, RejectsInvalidStrings) {
  for (const char* text :
       {"", "1 2 3", "0 0 0 0 0 0 2", "0 0 0 0 0 0 1 0", "0 0 0 0 0 0 x", "nan 0 0 0 0 0 1"}) {
    EXPECT_THAT(thrown_message([&] { parse_extrinsic(text, "--sensor"); }),
                HasSubstr("it must be x y z qx qy qz qw"))
        << text;
  }
}

BodyPose pose_at(double x, double yaw = 0.0) {
  return {.position = {x, 0, 0},
          .turn = Quaterniond(AngleAxisd(yaw, Vector3d::UnitZ())),
          .covariance = Covariance::Identity() * (1.0 + x)};
}

TEST(PoseHistory, InterpolatesPosesLinearly) {
  PoseHistory history({});
  history.add(seconds(10.1), pose_at(1.0, 0.4));  // out of order
  history.add(seconds(10.0), pose_at(0.0, 0.0));
  const PoseMatch match = history.at(seconds(10.025));
  ASSERT_EQ(match.state, PoseMatch::State::known);
  EXPECT_NEAR(match.pose.position.x(), 0.25, 1e-9);
  EXPECT_NEAR(AngleAxisd(match.pose.turn).angle(), 0.1, 1e-9);
  EXPECT_NEAR(match.pose.covariance.value()(3, 3), 1.25, 1e-9);
  EXPECT_EQ(history.at(seconds(10.1)).pose.position.x(), 1.0);
}

TEST(PoseHistory, InterpolatesRotationAlongShorterArc) {
  PoseHistory history({});
  BodyPose other = pose_at(0.0, 0.2);
  other.turn.coeffs() *= -1.0;
  history.add(seconds(10.0), pose_at(0.0, 0.0));
  history.add(seconds(10.1), other);
  const PoseMatch match = history.at(seconds(10.05));
  ASSERT_EQ(match.state, PoseMatch::State::known);
  EXPECT_NEAR(match.pose.turn.angularDistance(pose_at(0.0, 0.1).turn), 0.0, 1e-9);
}

TEST(PoseHistory, ReportsReasonForUnknownPose) {
  PoseHistory history({});
  const auto expect = [&](double time, PoseMatch::State state, const std::string& reason) {
    const PoseMatch match = history.at(seconds(time));
    EXPECT_EQ(match.state, state) << time;
    EXPECT_THAT(match.reason, HasSubstr(reason)) << time;
  };
  expect(5.0, PoseMatch::State::open, "after it");
  history.add(seconds(10.0), pose_at(0.0));
  history.add(seconds(10.3), pose_at(0.0));
  history.add(seconds(10.35), pose_at(10.0));      // 200 m/s
  history.add(seconds(10.4), pose_at(10.0, 3.0));  // 60 rad/s
  history.add(seconds(4e9 / 2), pose_at(5.0));     // years ahead
  expect(9.95, PoseMatch::State::open, "before it");
  expect(10.05, PoseMatch::State::open, "after it");
  expect(10.25, PoseMatch::State::open, "before it");
  expect(10.32, PoseMatch::State::rejected, "at an implausible speed of 200 m/s");
  expect(10.38, PoseMatch::State::rejected, "60 rad/s");
  expect(10.45, PoseMatch::State::open, "after it");
}

TEST(PoseHistory, KeepsFirstPoseOfEqualStamps) {
  PoseHistory history({});
  EXPECT_EQ(history.add(seconds(1.0), pose_at(1.0)), PoseHistory::Added::accepted);
  EXPECT_EQ(history.add(seconds(1.0), pose_at(1.0)), PoseHistory::Added::known);
  EXPECT_EQ(history.add(seconds(1.0), pose_at(2.0)), PoseHistory::Added::contradicts);
  EXPECT_EQ(history.at(seconds(1.0)).pose.position.x(), 1.0);
}

/// The oldest received pose is discarded first, even if its timestamp is far in the future.
TEST(PoseHistory, DiscardsEarliestReceivedPosesWhenFull) {
  PoseHistory history({.max = 3});
  history.add(seconds(1e9), pose_at(0.0));
  for (int i = 1; i <= 3; ++i) history.add(seconds(i), pose_at(i));
  EXPECT_NE(history.at(seconds(1e9)).state, PoseMatch::State::known);
  EXPECT_EQ(history.at(seconds(1.0)).state, PoseMatch::State::known);
}

TEST(Stamps, RejectsInvalidTimestamps) {
  std::string frame;
  Header header = make_header(seconds(0.0), frame);
  EXPECT_THAT(thrown_message([&] { to_stamp(header); }), HasSubstr("not set"));
  header.stamp = {.sec = -1, .nanosec = 5};
  EXPECT_THAT(thrown_message([&] { to_stamp(header); }), HasSubstr("not set"));
  header.stamp = {.sec = 1, .nanosec = 1'000'000'000};
  EXPECT_THAT(thrown_message([&] { to_stamp(header); }), HasSubstr("nanoseconds"));
  header.stamp = {.sec = 2'147'483'647, .nanosec = 999'999'999};
  EXPECT_EQ(to_stamp(header), 2'147'483'647'999'999'999);
}

}  // namespace
}  // namespace skycap::ros2
