#include "sim/sensors/trajectory.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/support/complaint.h"

namespace skycap::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;

Quaterniond yaw(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitZ())); }

TEST(Trajectory, InterpolatesPositionAndAttitude) {
  const Trajectory trajectory({{1.0, {0, 0, 0}, yaw(0.2)}, {3.0, {4, 2, 0}, yaw(1.2)}});
  for (const double time : {1.0, 1.3, 2.0, 2.9, 3.0}) {
    const double share = (time - 1.0) / 2.0;
    const Eigen::Isometry3d pose = trajectory.pose(time);
    EXPECT_TRUE(pose.translation().isApprox(share * Vector3d(4, 2, 0), 1e-12));
    EXPECT_TRUE(pose.linear().isApprox(yaw(0.2 + share).toRotationMatrix(), 1e-12));
  }
}

TEST(Trajectory, HoldsPoseBeforeStartAndAfterEnd) {
  const Trajectory trajectory({{1.0, {1, 0, 0}, yaw(0.2)}, {3.0, {4, 2, 0}, yaw(1.2)}});
  EXPECT_TRUE(trajectory.pose(0.0).isApprox(trajectory.pose(1.0)));
  EXPECT_TRUE(trajectory.pose(9.0).isApprox(trajectory.pose(3.0)));
}

// A quaternion and its negative are the same attitude. The interpolation must use the shorter
// rotation.
TEST(Trajectory, InterpolatesAlongShorterRotation) {
  Quaterniond negative = yaw(0.4);
  negative.coeffs() *= -1.0;
  const Trajectory trajectory({{0.0, {0, 0, 0}, yaw(0.2)}, {1.0, {0, 0, 0}, negative}});
  EXPECT_TRUE(trajectory.pose(0.5).linear().isApprox(yaw(0.3).toRotationMatrix(), 1e-12));
}

TEST(Trajectory, ReportsTheInvalidPose) {
  try {
    const Trajectory trajectory({{.time = 0.0}, {.time = 1.0}, {.time = 1.0}});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("pose 2 must be later than the previous pose"));
  }
  EXPECT_THAT(testing_support::thrown_message([&] { Trajectory(std::vector<StampedPose>{}); }),
              testing::HasSubstr("has no poses"));
  EXPECT_THAT(
      testing_support::thrown_message([&] { Trajectory(std::vector<StampedPose>{{.time = NAN}}); }),
      testing::HasSubstr("pose 0 has a non-finite value"));
  EXPECT_THAT(testing_support::thrown_message([&] {
                Trajectory(std::vector<StampedPose>{{.attitude = Quaterniond(0, 0, 0, 0)}});
              }),
              testing::HasSubstr("pose 0 has an attitude quaternion of zero length"));
}

// A Gauss-Markov process sampled every tau has a correlation of 1/e between neighbours. N = 40,000
// samples are equivalent to N (1 - 1/e^2) / (1 + 1/e^2) = 30,000 independent ones. Four standard
// deviations of the variance are 4 sqrt(2 / 30,000) = 3.3%.
TEST(EstimatedTrajectory, HasErrorsOfGivenSizeAndCorrelationTime) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 40'000; ++i) poses.push_back({5.0 * i, {1, 2, 3}, yaw(0.7)});
  const Trajectory ground_truth(poses);
  const NavigationErrors errors{.horizontal_sigma = 0.02,
                                .vertical_sigma = 0.05,
                                .tilt_sigma = 0.001,
                                .heading_sigma = 0.004,
                                .correlation_time = 5.0,
                                .seed = 3};
  const Trajectory estimated = estimated_trajectory(ground_truth, errors);
  Vector3d square = Vector3d::Zero(), turn_square = Vector3d::Zero();
  double neighbours = 0.0, before = 0.0, east_and_north = 0.0, north_and_height = 0.0;
  for (const StampedPose& pose : estimated.poses()) {
    const Vector3d error = pose.position - Vector3d(1, 2, 3);
    const AngleAxisd turned(yaw(0.7).conjugate() * pose.attitude);
    square += error.cwiseAbs2() / 40'000;
    turn_square += (turned.angle() * turned.axis()).cwiseAbs2() / 40'000;
    neighbours += error.x() * before / 40'000;
    before = error.x();
    east_and_north += error.x() * error.y() / 40'000;
    north_and_height += error.y() * error.z() / 40'000;
  }
  const auto expect_variance = [](double variance, double sigma) {
    EXPECT_NEAR(variance, sigma * sigma, 0.033 * sigma * sigma);
  };
  expect_variance(square.x(), 0.02);
  expect_variance(square.y(), 0.02);
  expect_variance(square.z(), 0.05);
  expect_variance(turn_square.x(), 0.001);
  expect_variance(turn_square.y(), 0.001);
  expect_variance(turn_square.z(), 0.004);
  EXPECT_NEAR(neighbours / square.x(), std::exp(-1.0), 0.03);
  EXPECT_NEAR(east_and_north / (0.02 * 0.02), 0.0, 0.03);
  EXPECT_NEAR(north_and_height / (0.02 * 0.05), 0.0, 0.03);
}

TEST(EstimatedTrajectory, EqualsGroundTruthWithoutErrors) {
  const Trajectory ground_truth({{0.0, {1, 2, 3}, yaw(0.7)}, {2.0, {2, 2, 3}, yaw(0.9)}});
  const Trajectory estimated = estimated_trajectory(ground_truth, {});
  EXPECT_TRUE(estimated.pose(1.3).isApprox(ground_truth.pose(1.3), 1e-15));
}

TEST(EstimatedTrajectory, HasOtherErrorsForAnotherSeed) {
  const Trajectory ground_truth({{0.0, {1, 2, 3}, yaw(0.7)}, {2.0, {2, 2, 3}, yaw(0.9)}});
  NavigationErrors errors{.horizontal_sigma = 0.02, .seed = 3};
  const Vector3d first = estimated_trajectory(ground_truth, errors).pose(1.3).translation();
  EXPECT_EQ(estimated_trajectory(ground_truth, errors).pose(1.3).translation(), first);
  errors.seed = 4;
  EXPECT_NE(estimated_trajectory(ground_truth, errors).pose(1.3).translation(), first);
}

TEST(NavigationErrors, RejectNegativeSigma) {
  try {
    NavigationErrors{.tilt_sigma = -1.0}.validate();
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("navigation.tilt_sigma is -1"));
  }
}

}  // namespace
}  // namespace skycap::sim
