#include "sim/sensors/lidar.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/sensors/scan_pattern.h"
#include "tests/sim/shapes.h"
#include "tests/support/complaint.h"

namespace skycap::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double degree = std::numbers::pi / 180.0;

Trajectory standing(const Vector3d& position = {0, 0, 0}, double duration = 1.0) {
  return Trajectory(
      {{0.0, position, Quaterniond::Identity()}, {duration, position, Quaterniond::Identity()}});
}

// Returns a scanner with 16 lasers, 500 firings per revolution and 20 revolutions per second.
LidarConfig spinner(int channels = 16) {
  LidarConfig config;
  config.firing_period = 1e-4;
  config.rotation_rate = 20.0;
  config.channels.clear();
  for (int i = 0; i < channels; ++i) {
    config.channels.push_back({.elevation = (2.0 * i - 15.0) * degree, .delay = 2e-6 * i});
  }
  return config;
}

Vector3d world(const LidarReturns& returns, const Vector3f& point) {
  return returns.origin + point.cast<double>();
}

LidarReturns measure_standing(const LidarConfig& config, const Scene& scene,
                              const Vector3d& position = {0, 0, 0}, std::uint64_t firings = 500) {
  const Trajectory trajectory = standing(position);
  return Lidar(config).measure(scene, {trajectory, trajectory}, {0, firings});
}

// For triangles that extend to 280 m, single precision has steps of 3e-5 m.
TEST(Lidar, MeasuresTiltedWallInEveryDirection) {
  const Vector3d normal = Vector3d(-1.0, 0.3, 0.2).normalized();
  const Scene scene(square({10, 0, 0}, normal, 400.0), 1);
  LidarConfig config = spinner();
  config.max_range = 100.0;
  const LidarReturns returns = measure_standing(config, scene);
  ASSERT_GT(returns.size(), 2000U);
  std::set<std::uint16_t> channels;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    EXPECT_NEAR(normal.dot(world(returns, returns.points[i]) - Vector3d(10, 0, 0)), 0.0, 6e-5);
    EXPECT_EQ(returns.points[i], returns.true_points[i]);
    channels.insert(returns.channels[i]);
  }
  EXPECT_EQ(channels.size(), 16U);
}

// Pulse rate: channels / firing period. Inside a sphere all pulses return. OS1-128 with 2048
// columns at 10 Hz: 2,621,440 per second; here 1/64 of it.
TEST(Lidar, ReturnsOnePointPerPulse) {
  LidarConfig config = spinner(128);
  for (int i = 0; i < 128; ++i)
    config.channels[i] = {.elevation = (i * 45.0 / 127 - 22.5) * degree};
  config.firing_period = 1.0 / 20'480;
  config.rotation_rate = 10.0;
  const Scene scene(sphere({0, 0, 0}, 30.0, 4), 1);
  const Trajectory trajectory = standing({1, 2, 3}, 1.0 / 64);
  const Lidar lidar(config);
  ASSERT_EQ(lidar.firings(trajectory), 320U);
  const LidarReturns returns = lidar.measure(scene, {trajectory, trajectory}, {0, 320});
  EXPECT_EQ(returns.size(), 2'621'440U / 64);
  EXPECT_EQ(returns.times.size(), returns.size());
  EXPECT_EQ(lidar.firings(standing({0, 0, 0}, 1.0)), 20'480U);
}

class MovingLidar : public testing::Test {
 protected:
  // 10 m/s along x with a yaw rate of 30 degrees per second, along a wall at y = 20.
  static constexpr double speed = 10.0, yaw_rate = 30 * degree;
  const Scene scene{square({0, 20, 0}, {0, -1, 0}, 400.0), 1};
  static StampedPose pose_at(double time) {
    return {
        time, {speed * time, 0, 0}, Quaterniond(AngleAxisd(yaw_rate * time, Vector3d::UnitZ()))};
  }
  const Trajectory trajectory{{pose_at(0.0), pose_at(0.05), pose_at(0.1)}};
  const LidarReturns returns = Lidar(spinner()).measure(scene, {trajectory, trajectory}, {0, 1000});
};

// Compares each pulse with the closed form: the intersection of the ray with the wall, from the
// pulse's own time, pose and direction.
TEST_F(MovingLidar, HasOwnTimeAndPoseForEveryPulse) {
  ASSERT_GT(returns.size(), 5000U);
  const LidarConfig config = spinner();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const double time = returns.times[i];
    const Channel& laser = config.channels[returns.channels[i]];
    const double azimuth = 2.0 * std::numbers::pi * config.rotation_rate * time;
    const Isometry3d pose = trajectory.pose(time);
    const Vector3d direction =
        pose.linear() * Vector3d(std::cos(laser.elevation) * std::cos(azimuth),
                                 std::cos(laser.elevation) * std::sin(azimuth),
                                 std::sin(laser.elevation));
    const Vector3d expected = pose.translation() + 20.0 / direction.y() * direction;
    const Vector3d measured = world(returns, returns.points[i]);
    const double range = (expected - pose.translation()).norm();
    // The error across the ray is the single-precision error of its direction. Along the ray it is
    // larger at grazing incidence.
    EXPECT_LT((measured - expected).norm(), 1e-6 * range * range / 20.0 + 2e-5);
    EXPECT_NEAR(measured.y(), 20.0, 5e-5);
  }
}

// In the frame of the scan's start, points are displaced by the platform motion since then: v t and
// the rotation. Correcting it with the reported times restores the wall.
TEST_F(MovingLidar, ReportsTimesThatAllowMotionCorrection) {
  ASSERT_GT(returns.size(), 0U);
  for (std::size_t i = 0; i < returns.size(); i += 7) {
    const Isometry3d pose = trajectory.pose(returns.times[i]);
    const Vector3d in_sensor = pose.inverse() * world(returns, returns.points[i]);
    const Vector3d skewed = trajectory.pose(0.0) * in_sensor;
    const Vector3d turned = AngleAxisd(yaw_rate * returns.times[i], Vector3d::UnitZ()) * skewed;
    EXPECT_NEAR(turned.y(), 20.0, 5e-5);
    EXPECT_NEAR((world(returns, returns.points[i]) - turned).x(), speed * returns.times[i], 1e-4);
  }
}

TEST(Lidar, MatchesWholeScanInParts) {
  LidarConfig config = spinner();
  config.errors = {.sigma = 0.01, .channel_bias_sigma = 0.01, .angle_sigma = 1e-4};
  const Scene scene(sphere({0, 0, 0}, 30.0, 3), 1);
  const Trajectory trajectory({{0.0, {0, 0, 0}, Quaterniond::Identity()},
                               {1.0, {9, 0, 0}, Quaterniond(AngleAxisd(1.0, Vector3d::UnitX()))}});
  const Lidar lidar(config);
  const LidarFlight flight{trajectory, trajectory};
  const LidarReturns whole = lidar.measure(scene, flight, {100, 150});
  LidarReturns parts;
  for (const FiringRange part : {FiringRange{100, 1}, {101, 59}, {160, 32}, {192, 58}}) {
    const LidarReturns some = lidar.measure(scene, flight, part);
    parts.points.insert(parts.points.end(), some.points.begin(), some.points.end());
    parts.times.insert(parts.times.end(), some.times.begin(), some.times.end());
  }
  const LidarReturns buffer = lidar.measure(scene, flight, {100, 150}, whole);
  EXPECT_EQ(buffer.points, whole.points);
  EXPECT_EQ(buffer.channels, whole.channels);
  EXPECT_EQ(parts.points, whole.points);
  EXPECT_EQ(parts.times, whole.times);
}

// The largest incidence angle at which a floor returns is where R^2 / cos reaches R_ref^2 rho /
// rho_ref.
TEST(Lidar, LosesGrazingReturnsAccordingToLidarEquation) {
  const double height = 4.0, reference = 20.0, reflectance = 0.3;
  const geometry::Mesh floor = square({0, 0, -height}, {0, 0, 1}, 4000.0);
  const Scene scene(floor, std::vector<float>{0.3F, 0.3F}, 1);
  LidarConfig config = spinner(400);
  for (int i = 0; i < 400; ++i) config.channels[i] = {.elevation = -(1.0 + 0.05 * i) * degree};
  config.max_range = 1000.0;
  config.sensitivity = {.reference_range = reference, .reference_reflectance = 0.1};
  const LidarReturns returns = measure_standing(config, scene, {0, 0, 0}, 5);
  // cos = h / R, so R^3 = h R_ref^2 rho / rho_ref.
  const double farthest = std::cbrt(height * reference * reference * reflectance / 0.1);
  double last = 0.0;
  for (const Vector3f& point : returns.points) {
    last = std::max(last, world(returns, point).norm());
  }
  EXPECT_LE(last, farthest + 1e-4);
  EXPECT_GT(last, farthest - 0.2);  // there, channels are 0.05 degrees or 0.15 m apart
}

// A hole of 1 cm in a wall and a beam of 13.5 cm: a single ray passes through the hole, but the
// beam also hits the wall.
TEST(Lidar, ReturnsWallAndHoleForWideBeam) {
  geometry::Mesh mesh;
  for (const auto& [y, z] : {std::pair{-1.005, 0.0}, {1.005, 0.0}, {0.0, -1.005}, {0.0, 1.005}}) {
    geometry::append(mesh, square({10, y, z}, {-1, 0, 0}, 2.0));
  }
  geometry::append(mesh, square({20, 0, 0}, {-1, 0, 0}, 50.0));
  const Scene scene(mesh, 1);
  LidarConfig config;
  config.rotation_rate = 0.0;
  const LidarReturns one_ray = measure_standing(config, scene, {0, 0, 0}, 1);
  ASSERT_EQ(one_ray.size(), 1U);
  EXPECT_NEAR(world(one_ray, one_ray.points[0]).x(), 20.0, 1e-5);

  config.beam = {
      .rings = 2, .divergence_horizontal = 0.0135, .divergence_vertical = 0.0135, .max_returns = 3};
  const LidarReturns wide = measure_standing(config, scene, {0, 0, 0}, 1);
  ASSERT_EQ(wide.size(), 2U);
  EXPECT_NEAR(world(wide, wide.points[0]).x(), 10.0, 1e-3);
  EXPECT_NEAR(world(wide, wide.points[1]).x(), 20.0, 1e-5);
  EXPECT_THAT(wide.return_numbers, testing::ElementsAre(1, 2));
  EXPECT_THAT(wide.number_of_returns, testing::ElementsAre(2, 2));
  // Of 19 rays, only the axis passes through the hole, with its weight of the Gaussian.
  const double axis = 1.0 / (1.0 + 6.0 * std::exp(-0.5) + 12.0 * std::exp(-2.0));
  EXPECT_NEAR(wide.intensities[1] / (wide.intensities[0] + wide.intensities[1]), axis, 1e-3);
}

// gamma R / 2 across the slope and gamma R / (2 cos theta) along it. When an edge moves through the
// footprint, half of the beam is beyond it at the centre.
TEST(Lidar, HasFootprintOfBeamDivergence) {
  LidarConfig config;
  config.rotation_rate = 0.0;
  config.beam = {
      .rings = 8, .divergence_horizontal = 0.004, .divergence_vertical = 0.010, .max_returns = 2};
  const auto share_beyond = [&](const Vector3d& edge_shift) {
    const Scene scene(square(Vector3d(50, 0, 0) + edge_shift, {-1, 0, 0}, 20.0), 1);
    const LidarReturns returns = measure_standing(config, scene, {0, 0, 0}, 1);
    return returns.size() == 0 ? 0.0 : returns.intensities[0] / Scene::default_reflectance;
  };
  // The left edge of the square is at y = shift - 10. The radii of the footprint are 0.1 and 0.25
  // m.
  EXPECT_NEAR(share_beyond({0, 10.0, 0}), 0.5, 0.08);
  EXPECT_NEAR(share_beyond({0, 9.89, 0}), 1.0, 1e-3);
  EXPECT_EQ(share_beyond({0, 10.101, 0}), 0.0);
  EXPECT_GT(share_beyond({0, 10.09, 0}), 0.0);
  EXPECT_NEAR(share_beyond({0, 0, 10.0}), 0.5, 0.08);
  EXPECT_EQ(share_beyond({0, 0, 10.251}), 0.0);
  EXPECT_GT(share_beyond({0, 0, 10.22}), 0.0);
}

TEST(Lidar, ReturnsMultiplesOfRangeStep) {
  LidarConfig config = spinner();
  config.errors = {.sigma = 0.02, .range_step = 0.004};
  const LidarReturns returns = measure_standing(config, Scene(sphere({0, 0, 0}, 10.0, 5), 1));
  std::set<double> numbers;
  for (const Vector3f& point : returns.points) {
    const double steps = world(returns, point).norm() / 0.004;
    EXPECT_NEAR(steps, std::round(steps), 1e-3);  // single precision at 10 m
    numbers.insert(std::round(steps));
  }
  EXPECT_GT(numbers.size(), 15U) << "the noise of 5 steps spreads them";
}

// Range errors along the ray: the mean of each channel is its bias, and the rest is noise. The
// tolerance is four standard deviations for N = 5000 firings.
TEST(Lidar, SeparatesChannelBiasFromPulseNoise) {
  LidarConfig config = spinner(64);
  for (int i = 0; i < 64; ++i) config.channels[i] = {.elevation = 0.3 * i * degree};
  config.errors = {.sigma = 0.01, .channel_bias_sigma = 0.03};
  const std::uint64_t firings = 5000;
  const LidarReturns returns =
      measure_standing(config, Scene(sphere({0, 0, 0}, 10.0, 4), 1), {0, 0, 0}, firings);
  ASSERT_EQ(returns.size(), 64 * firings);
  std::vector<double> mean(64, 0.0), square(64, 0.0);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Vector3d truth = world(returns, returns.true_points[i]);
    const Vector3d difference = world(returns, returns.points[i]) - truth;
    const double error = difference.dot(truth.normalized());
    EXPECT_LT((difference - error * truth.normalized()).norm(), 1e-5);
    mean[returns.channels[i]] += error / static_cast<double>(firings);
    square[returns.channels[i]] += error * error / static_cast<double>(firings);
  }
  double between = 0.0, inside = 0.0;
  for (int i = 0; i < 64; ++i) {
    between += mean[i] * mean[i] / 64;
    inside += (square[i] - mean[i] * mean[i]) / 64;
  }
  EXPECT_NEAR(inside, 1e-4, 4e-4 * std::sqrt(2.0 / (64.0 * firings)) + 1e-7);
  EXPECT_NEAR(between, 9e-4, 4 * 9e-4 * std::sqrt(2.0 / 64.0));
}

TEST(Lidar, HitsSameSurfacesWithNoise) {
  const Scene scene(sphere({5, 0, 0}, 3.0, 4), 1);
  LidarConfig config = spinner();
  const LidarReturns exact = measure_standing(config, scene);
  config.errors = {.sigma = 0.5, .channel_bias_sigma = 0.5, .angle_sigma = 0.01};
  config.seed = 8;
  const LidarReturns noisy = measure_standing(config, scene);
  EXPECT_EQ(noisy.true_points, exact.true_points);
  EXPECT_EQ(noisy.times, exact.times);
  EXPECT_NE(noisy.points, exact.points);
}

// From height h straight down, a roll of phi that is estimated as zero displaces the point by h
// tan(phi).
TEST(Lidar, DisplacesPointsByRollLeverArmAndBoresightErrors) {
  const double height = 40.0;
  const Scene scene(square({0, 0, 0}, {0, 0, 1}, 400.0), 1);
  LidarConfig config;
  config.rotation_rate = 0.0;
  const Lidar lidar(config);
  // The sensor's x axis, its firing direction, points down.
  Isometry3d down = Isometry3d::Identity();
  down.rotate(AngleAxisd(90 * degree, Vector3d::UnitY()));
  const Trajectory level = standing({0, 0, height});
  const double roll = 0.02;
  const Quaterniond rolled(AngleAxisd(roll, Vector3d::UnitX()));
  const Trajectory really({{0.0, {0, 0, height}, rolled}, {1.0, {0, 0, height}, rolled}});

  const LidarReturns returns = lidar.measure(scene, {really, level, down, down}, {0, 1});
  ASSERT_EQ(returns.size(), 1U);
  EXPECT_NEAR(world(returns, returns.true_points[0]).y(), height * std::tan(roll), 1e-5);
  EXPECT_NEAR(world(returns, returns.points[0]).y(), 0.0, 1e-5);
  EXPECT_NEAR(world(returns, returns.points[0]).z(), height - height / std::cos(roll), 1e-5);

  Isometry3d displaced = down;
  displaced.pretranslate(Vector3d(0.1, -0.2, 0.3));
  const LidarReturns moved = lidar.measure(scene, {level, level, down, displaced}, {0, 1});
  EXPECT_TRUE(world(moved, moved.points[0]).isApprox(Vector3d(0.1, -0.2, 0.3), 1e-4));

  Isometry3d turned = down;
  turned.prerotate(AngleAxisd(0.001, Vector3d::UnitX()));
  const LidarReturns off = lidar.measure(scene, {level, level, down, turned}, {0, 1});
  EXPECT_NEAR(world(off, off.points[0]).y(), height * std::sin(0.001), 1e-5);
  EXPECT_NEAR(world(off, off.true_points[0]).norm(), 0.0, 1e-5);
}

TEST(Lidar, KeepsPointsFarFromOrigin) {
  const Vector3d far(474'500.0, 5'474'500.0, 120.0);
  const Scene here(sphere({0, 0, 0}, 20.0, 4), 1), there(sphere(far, 20.0, 4), 1);
  const LidarReturns near_returns = measure_standing(spinner(), here, {1, 2, 3});
  const LidarReturns far_returns = measure_standing(spinner(), there, far + Vector3d(1, 2, 3));
  ASSERT_EQ(far_returns.size(), near_returns.size());
  for (std::size_t i = 0; i < near_returns.size(); ++i) {
    const Vector3d moved = world(far_returns, far_returns.points[i]) - far;
    EXPECT_LT((moved - world(near_returns, near_returns.points[i])).norm(), 1e-4);
  }
}

TEST(Lidar, OccludesSurfacesBehindTooNearSurface) {
  geometry::Mesh mesh = sphere({0, 0, 0}, 1.0, 3);
  geometry::append(mesh, sphere({0, 0, 0}, 5.0, 3));
  LidarConfig config = spinner();
  config.min_range = 2.0;
  EXPECT_EQ(measure_standing(config, Scene(mesh, 1)).size(), 0U);
}

TEST(Scene, RejectsWrongNumberOfReflectances) {
  EXPECT_THAT(testing_support::thrown_message([&] {
                Scene(square({0, 0, 0}, {0, 0, 1}, 1.0), std::vector<float>{0.5F}, 1);
              }),
              testing::HasSubstr("there are 1 reflectances for 2 triangles"));
}

}  // namespace
}  // namespace skycap::sim
