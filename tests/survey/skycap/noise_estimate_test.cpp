#include "survey/skycap/noise_estimate.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3f;

const geometry::Camera camera{geometry::CameraConfig{}};
const std::vector<tests::Sphere> ball = {{}};

skycap::BlockImage image_of(const geometry::Scan& scan) {
  return skycap::make_block_image(scan, camera, {.block_px = 4, .jump = 0.1F});
}

TEST(NoiseEstimate, KnowsNothingBeforeTheFirstScan) {
  EXPECT_FALSE(skycap::NoiseEstimate().noise(0.0));
}

// The lower quartile of estimates from 400 returns is 3 % low; curvature adds a little.
TEST(NoiseEstimate, FindsIsotropicNoise) {
  skycap::NoiseEstimate estimate;
  estimate.add(
      image_of(tests::scan_spheres(ball, camera, geometry::look_at({2, 0, 0}, {0, 0, 0}), 0.01)));
  const auto noise = estimate.noise(0.0);
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->across(1.0), 0.01, 0.001);
  EXPECT_NEAR(noise->across(0.6), 0.01, 0.001);
}

TEST(NoiseEstimate, TellsNoiseAlongTheRayFromIsotropicNoise) {
  geometry::Scan scan = tests::scan_spheres(ball, camera, geometry::look_at({2, 0, 0}, {0, 0, 0}));
  std::mt19937_64 random(2);
  std::normal_distribution<float> normal(0.0F, 0.01F);
  for (Vector3f& point : scan.points) {
    const Vector3f ray = (point - Vector3f(2, 0, 0)).normalized();
    point += normal(random) * ray;
  }
  skycap::NoiseEstimate estimate;
  estimate.add(image_of(scan));
  const auto noise = estimate.noise(0.0);
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->across(1.0), 0.01, 0.0015);
  EXPECT_GT(noise->along_ray, 2.0 * noise->isotropic);
}

TEST(NoiseEstimate, CallsNegligibleNoiseNone) {
  skycap::NoiseEstimate estimate;
  estimate.add(
      image_of(tests::scan_spheres(ball, camera, geometry::look_at({2, 0, 0}, {0, 0, 0}))));
  const auto noise = estimate.noise(6e-4);  // the sphere's curvature alone shows 0.2 mm
  ASSERT_TRUE(noise);
  EXPECT_EQ(noise->across(1.0), 0.0);
}

}  // namespace
}  // namespace skycap::survey
