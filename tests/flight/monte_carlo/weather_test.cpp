#include "flight/monte_carlo/weather.h"

#include <cmath>

#include <gtest/gtest.h>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

TEST(RandomNumbers, AreNormalAndUniformBySeedAndStream) {
  geometry::RandomNumbers random(3, 4), same(3, 4), other(3, 5);
  double sum = 0.0, squares = 0.0, uniforms = 0.0;
  constexpr int count = 200'000;
  for (int i = 0; i < count; ++i) {
    const double normal = random.normal(), uniform = random.uniform();
    ASSERT_EQ(normal, same.normal());
    ASSERT_EQ(uniform, same.uniform());
    ASSERT_NE(uniform, other.uniform());
    ASSERT_TRUE(uniform >= 0.0 && uniform < 1.0);
    sum += normal, squares += normal * normal, uniforms += uniform;
  }
  // Four standard errors of each mean.
  const double error = 4.0 / std::sqrt(static_cast<double>(count));
  EXPECT_NEAR(sum / count, 0.0, error);
  EXPECT_NEAR(squares / count, 1.0, std::sqrt(2.0) * error);
  EXPECT_NEAR(uniforms / count, 0.5, std::sqrt(1.0 / 12.0) * error);
}

// MIL-F-8785C at 20 ft, where W20 is measured: with h = 20, shape = 0.19346, sigma_w = 0.1 W20 and
// sigma_u = sigma_w / shape^0.4 = 0.1929 W20. The wind is 10 m/s from the west.
TEST(Weather, HasDrydenGustStrength) {
  geometry::RandomNumbers random(1, 1);
  Weather weather({10.0, 0.0}, random);
  Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero();
  constexpr int count = 400'000;
  for (int i = 0; i < count; ++i) {
    const Vector3d air = weather.next(0.5, 6.096, 10.0) - Vector3d(10.0, 0.0, 0.0);
    sum += air;
    squares += air.cwiseAbs2();
  }
  // Length scales of 44 m and 6 m give 23,000 and 160,000 independent samples. 2% is four standard
  // errors.
  EXPECT_NEAR(std::sqrt(squares.x() / count), 1.929, 0.04);
  EXPECT_NEAR(std::sqrt(squares.y() / count), 1.929, 0.04);
  EXPECT_NEAR(std::sqrt(squares.z() / count), 1.0, 0.02);
  EXPECT_NEAR((sum / count).norm(), 0.0, 0.1);
}

TEST(Weather, IsCalmWithoutWind) {
  geometry::RandomNumbers random(1, 1);
  Weather weather({0.0, 0.0}, random);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(weather.next(0.1, 10.0, 3.0), Vector3d::Zero());
}

// Property: the error never exceeds the bound, sometimes comes close to it, and does not jump.
TEST(ReceiverError, StaysWithinBoundAndChangesSlowly) {
  geometry::RandomNumbers random(2, 1);
  ReceiverError receiver(0.3, random);
  double max = 0.0;
  Vector3d before = receiver.next(0.04);
  for (int i = 0; i < 500'000; ++i) {
    const Vector3d error = receiver.next(0.04);
    ASSERT_LE(error.norm(), 0.3 + 1e-12);
    ASSERT_LT((error - before).norm(), 0.03);
    max = std::max(max, error.norm());
    before = error;
  }
  EXPECT_GT(max, 0.28);
}

}  // namespace
}  // namespace skycap::flight
