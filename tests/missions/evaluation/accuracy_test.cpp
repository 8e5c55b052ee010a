#include "missions/evaluation/accuracy.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace skycap::missions {
namespace {

using Eigen::Vector3f;

/// Square from (-2, -2) to (2, 2) at z = 0.
const geometry::Mesh square{{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}},
                            {{0, 1, 2}, {0, 2, 3}}};

std::vector<Vector3f> noisy_points(int count, float sigma) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> uniform(-1.9F, 1.9F);
  std::normal_distribution<float> noise(0.0F, sigma);
  std::vector<Vector3f> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    points.push_back(Vector3f{uniform(random), uniform(random), noise(random)});
  }
  return points;
}

// The distances of the points from the surface, on both sides, have a half-normal distribution.
TEST(AccuracyMeter, RecoversMeasurementNoise) {
  constexpr float sigma = 0.01F;
  evaluation::AccuracyMeter meter(square);
  meter.add(noisy_points(20'000, sigma));
  const evaluation::CloudAccuracy accuracy = meter.accuracy();
  // The standard errors for 20,000 values are below 1% of sigma. The tolerance is 3%.
  EXPECT_NEAR(accuracy.root_mean_square, sigma, 0.03 * sigma);
  EXPECT_NEAR(accuracy.mean, sigma * std::sqrt(2.0 / std::numbers::pi), 0.03 * sigma);
  EXPECT_NEAR(accuracy.median, 0.6745 * sigma, 0.03 * sigma);
  EXPECT_NEAR(accuracy.percentile_95, 1.96 * sigma, 0.05 * sigma);
  EXPECT_GE(accuracy.largest, accuracy.percentile_95);
}

// Five points with known distances: 1, 2, 3 and 4 above the square, and a 3-4-5 triangle next to
// its corner.
TEST(AccuracyMeter, ComputesKnownFiguresOfFivePoints) {
  evaluation::AccuracyMeter meter(square);
  meter.add(std::vector<Vector3f>{{0, 0, 3}, {1, 1, -1}, {5, 6, 0}, {0, 1, 4}, {-1, 0, 2}});
  EXPECT_EQ(meter.points(), 5U);
  EXPECT_DOUBLE_EQ(meter.share_within(3.0), 0.6);
  const evaluation::CloudAccuracy accuracy = meter.accuracy();
  EXPECT_DOUBLE_EQ(accuracy.mean, 3.0);
  EXPECT_DOUBLE_EQ(accuracy.root_mean_square, std::sqrt(11.0));
  EXPECT_DOUBLE_EQ(accuracy.median, 3.0);
  EXPECT_DOUBLE_EQ(accuracy.largest, 5.0);
}

TEST(AccuracyMeter, IsIndependentOfPiecesAndThreads) {
  const std::vector<Vector3f> points = noisy_points(10'000, 0.1F);
  evaluation::AccuracyMeter whole(square, 1), chunks(square, 3);
  whole.add(points);
  for (std::size_t begin = 0; begin < points.size(); begin += 2500) {
    chunks.add(std::span(points).subspan(begin, 2500));
  }
  const evaluation::CloudAccuracy one = whole.accuracy(), other = chunks.accuracy();
  EXPECT_EQ(one.mean, other.mean);
  EXPECT_EQ(one.root_mean_square, other.root_mean_square);
  EXPECT_EQ(one.percentile_95, other.percentile_95);
}

// Known case: a wall on the ground, in the plane x = 0. Points above the diagonal are closer to the
// wall.
TEST(AccuracyMeter, IgnoresPointsNearerToSurroundings) {
  const geometry::Mesh wall{{{0, -9, 0}, {0, 9, 0}, {0, 9, 9}, {0, -9, 9}}, {{0, 1, 2}, {0, 2, 3}}};
  const geometry::Mesh ground{{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}},
                              {{0, 1, 2}, {0, 2, 3}}};
  const std::vector<Eigen::Vector3f> points = {
      {0.25F, 0, 1}, {-0.5F, 1, 2}, {3, 0, 0.125F}, {-7, 2, -0.5F}, {0, 0, 0}};
  evaluation::AccuracyMeter meter(wall, 1, ground);
  meter.add(points);
  EXPECT_EQ(meter.points(), 3U);
  EXPECT_EQ(meter.surroundings(), 2U);
  EXPECT_DOUBLE_EQ(meter.accuracy().mean, 0.25);
  EXPECT_DOUBLE_EQ(meter.accuracy().largest, 0.5);
  evaluation::AccuracyMeter alone(wall, 1);
  alone.add(points);
  EXPECT_EQ(alone.points(), 5U);
  EXPECT_FLOAT_EQ(static_cast<float>(alone.accuracy().largest), std::hypot(7.0F, 0.5F));
}

TEST(AccuracyMeter, IsZeroWithoutPoints) {
  evaluation::AccuracyMeter meter(square);
  EXPECT_EQ(meter.accuracy().largest, 0.0);
  EXPECT_EQ(meter.share_within(1.0), 0.0);
}

}  // namespace
}  // namespace skycap::missions
