#include "survey/surfel/noise_estimate.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3f;

const geometry::Camera camera{geometry::CameraConfig{}};
const std::vector<tests::Sphere> ball = {{}};

surfel::BlockImage make_image(const geometry::Scan& scan) {
  return surfel::make_block_image(scan, camera, {.block_px = 4, .jump = 0.1F});
}

TEST(NoiseEstimate, IsEmptyBeforeFirstScan) {
  EXPECT_FALSE(surfel::NoiseEstimate().noise(0.0, 2.0));
}

// The lower quartile of estimates from 400 returns is 3% too low. Curvature adds a little.
TEST(NoiseEstimate, FindsIsotropicNoise) {
  surfel::NoiseEstimate estimate;
  estimate.add(
      make_image(tests::scan_spheres(ball, camera, geometry::look_at({2, 0, 0}, {0, 0, 0}), 0.01)));
  const auto noise = estimate.noise(0.0, 2.0);
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->across(1.0), 0.01, 0.001);
  EXPECT_NEAR(noise->across(0.6), 0.01, 0.001);
}

TEST(NoiseEstimate, DistinguishesAlongRayFromIsotropicNoise) {
  geometry::Scan scan = tests::scan_spheres(ball, camera, geometry::look_at({2, 0, 0}, {0, 0, 0}));
  std::mt19937_64 random(2);
  std::normal_distribution<float> normal(0.0F, 0.01F);
  for (Vector3f& point : scan.points) {
    const Vector3f ray = (point - Vector3f(2, 0, 0)).normalized();
    point += normal(random) * ray;
  }
  surfel::NoiseEstimate estimate;
  estimate.add(make_image(scan));
  const auto noise = estimate.noise(0.0, 2.0);
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->across(1.0), 0.01, 0.0015);
  EXPECT_GT(noise->along_ray, 2.0 * noise->isotropic);
}

TEST(NoiseEstimate, IsZeroForNegligibleNoise) {
  surfel::NoiseEstimate estimate;
  estimate.add(
      make_image(tests::scan_spheres(ball, camera, geometry::look_at({2, 0, 0}, {0, 0, 0}))));
  const auto noise = estimate.noise(6e-4, 2.0);  // the curvature of the sphere alone causes 0.2 mm
  ASSERT_TRUE(noise);
  EXPECT_EQ(noise->across(1.0), 0.0);
}

/// Balls of equal image size, side by side, from near to far. The noise along the ray is `constant`
/// plus `growing` times the squared depth.
surfel::BlockImage make_depth_image(double constant, double growing) {
  std::vector<tests::Sphere> balls;
  for (const double depth : {1.0, 1.6, 2.5, 3.8}) {
    const double side = balls.size() % 2 == 0 ? 0.45 : -0.45;
    const double up = balls.size() < 2 ? 0.22 : -0.22;
    balls.push_back({1.25 * depth * Eigen::Vector3d(-1.0, side, up), 0.3 * depth});
  }
  const geometry::View view{Eigen::Vector3d::Zero(), -Eigen::Vector3d::UnitX()};
  geometry::Scan scan = tests::scan_spheres(balls, camera, view);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (Vector3f& point : scan.points) {
    const double depth = -point.x();
    const double sigma = std::hypot(constant, growing * depth * depth);
    point += (sigma * normal(random) * point.cast<double>().normalized()).cast<float>();
  }
  return make_image(scan);
}

// 2 mm at 1 m, 32 mm at 4 m.
TEST(NoiseEstimate, FindsNoiseThatGrowsWithSquareOfRange) {
  surfel::NoiseEstimate estimate;
  estimate.add(make_depth_image(0.0, 0.002));
  const auto noise = estimate.noise(0.0, 2.0);
  ASSERT_TRUE(noise);
  EXPECT_GT(noise->growing, 0.8);
  for (const double depth : {1.0, 2.0, 3.0}) {
    const double expected = 0.002 * depth * depth;
    EXPECT_NEAR(noise->at(depth).across(1.0), expected, 0.25 * expected) << depth;
  }
}

TEST(NoiseEstimate, FindsNoGrowthForConstantNoise) {
  surfel::NoiseEstimate estimate;
  estimate.add(make_depth_image(0.01, 0.0));
  const auto noise = estimate.noise(0.0, 2.0);
  ASSERT_TRUE(noise);
  EXPECT_EQ(noise->growing, 0.0);
  EXPECT_NEAR(noise->across(1.0), 0.01, 0.0015);
}

}  // namespace
}  // namespace skycap::survey
