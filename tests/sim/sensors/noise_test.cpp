#include "sim/sensors/noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/sensors/vector_kernels.h"
#include "tests/support/complaint.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/not_empty.h"

namespace skycap::sim {
namespace {

constexpr std::size_t count = 1 << 20;

std::vector<float> normals(std::uint64_t seed, std::uint32_t stream, std::uint64_t frame) {
  std::vector<float> result(count);
  fill_normals(noise_key(seed, stream, frame), 0, result);
  return result;
}

double moment(const std::vector<float>& values, int power) {
  double sum = 0.0;
  for (const float value : values) sum += std::pow(static_cast<double>(value), power);
  return sum / static_cast<double>(values.size());
}

double correlation(const std::vector<float>& a, const std::vector<float>& b, std::size_t lag = 0) {
  double sum = 0.0;
  for (std::size_t i = 0; i + lag < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i + lag];
  return sum / static_cast<double>(a.size() - lag);
}

// The n-th moment of N normals has a standard deviation of sqrt(var(x^n) / N), where var is 1, 2,
// 15, 96 for n = 1 to 4. Each bound is four standard deviations.
TEST(Noise, HasMomentsOfStandardNormal) {
  const double unit = 4.0 / std::sqrt(static_cast<double>(count));
  for (const std::uint64_t seed : {0, 1, 2}) {
    const std::vector<float> sample = normals(seed, 0, 7);
    EXPECT_NEAR(moment(sample, 1), 0.0, unit);
    EXPECT_NEAR(moment(sample, 2), 1.0, unit * std::sqrt(2.0));
    EXPECT_NEAR(moment(sample, 3), 0.0, unit * std::sqrt(15.0));
    EXPECT_NEAR(moment(sample, 4), 3.0, unit * std::sqrt(96.0));
  }
}

// Kolmogorov-Smirnov: sqrt(N) D exceeds 1.95 in one of a thousand samples.
TEST(Noise, HasDistributionOfStandardNormal) {
  std::vector<float> sample = normals(5, 0, 0);
  std::sort(sample.begin(), sample.end());
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double expected = 0.5 * std::erfc(-sample[i] / std::sqrt(2.0));
    const double below = static_cast<double>(i) / count, up_to = below + 1.0 / count;
    largest = std::max({largest, std::abs(expected - below), std::abs(expected - up_to)});
  }
  EXPECT_LT(largest * std::sqrt(static_cast<double>(count)), 1.95);
}

// Of a million normals, 63 exceed 4 sigma (Poisson: 63 +- 4 * 8) and 0.6 exceed 5 sigma.
TEST(Noise, HasTailsOfStandardNormal) {
  const std::vector<float> sample = normals(11, 0, 0);
  const auto beyond = [&](float limit) {
    return std::count_if(sample.begin(), sample.end(),
                         [&](float value) { return std::abs(value) > limit; });
  };
  EXPECT_NEAR(static_cast<double>(beyond(4.0F)), 66.4, 33.0);
  EXPECT_LE(beyond(5.0F), 5);
}

// Correlations of independent normals are below 4 / sqrt(N) in 16,000 of 16,001 cases. Lags 16 and
// 32 are Box-Muller partners and neighbouring blocks; 2400 is the next image row.
TEST(Noise, IsUncorrelatedAcrossLagsStreamsFramesAndSeeds) {
  const double limit = 4.0 / std::sqrt(static_cast<double>(count));
  const std::vector<float> sample = normals(1, 0, 1);
  for (const std::size_t lag : {1, 2, 3, 4, 15, 16, 17, 32, 64, 848, 2400}) {
    EXPECT_NEAR(correlation(sample, sample, lag), 0.0, limit) << "lag " << lag;
  }
  EXPECT_NEAR(correlation(sample, normals(1, 1, 1)), 0.0, limit);
  EXPECT_NEAR(correlation(sample, normals(1, 0, 2)), 0.0, limit);
  EXPECT_NEAR(correlation(sample, normals(2, 0, 1)), 0.0, limit);
}

// Box-Muller partners share their radius. Their squares would correlate if the angle were not
// uniform.
TEST(Noise, HasUncorrelatedSquaresOfBoxMullerPartners) {
  std::vector<float> squares = normals(21, 0, 0);
  for (float& value : squares) value = (value * value - 1.0F) / std::sqrt(2.0F);
  EXPECT_NEAR(correlation(squares, squares, 16), 0.0,
              8.0 / std::sqrt(static_cast<double>(count)));  // var(x^2 y^2 / 2) is between 2 and 4
}

// A normal depends only on key and index, not on the beginning of the requested array.
TEST(Noise, DependsOnlyOnKeyAndIndex) {
  const NoiseKey key = noise_key(3, 1, 4);
  std::vector<float> whole(1000), part(777);
  fill_normals(key, 0, whole);
  fill_normals(key, 96, part);
  for (std::size_t i = 0; 96 + i < whole.size() && i < part.size(); ++i) {
    ASSERT_EQ(part[i], whole[96 + i]) << i;
  }
}

// Bitwise equal on each instruction set of this processor and for each array length.
TEST(Noise, IsSameOnAllInstructionSets) {
  const NoiseKey key = noise_key(99, 2, 3);
  for (const std::size_t length : {1UL, 31UL, 32UL, 127UL, 128UL, 129UL, count}) {
    std::vector<float> expected(length), sample(length);
    baseline_kernels.fill_normals(key, 64, expected.data(), length);
    for (const geometry::InstructionSet set : testing_support::not_empty(instruction_sets())) {
      const InstructionSetLimit limit(set);
      fill_normals(key, 64, sample);
      EXPECT_EQ(sample, expected) << static_cast<int>(set) << ", " << length;
    }
  }
}

TEST(NoiseConfig, RejectsNegativeSigma) {
  try {
    NoiseConfig{.sigma = -0.01}.validate();
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
    EXPECT_THAT(error.what(), testing::HasSubstr("noise.sigma is -0.01"));
  }
  EXPECT_THAT(testing_support::thrown_message([&] { NoiseConfig{.sigma = NAN}.validate(); }),
              testing::HasSubstr("noise.sigma is nan"));
}

}  // namespace
}  // namespace skycap::sim
