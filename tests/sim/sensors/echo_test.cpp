#include "sim/sensors/echo.h"

#include <cmath>
#include <limits>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::sim {
namespace {

constexpr Sensitivity sees_all = {};
const Beam beam = {.rings = 2, .pulse_length = 5e-9, .max_returns = 5};  // range resolution 0.75 m

std::vector<RayHit> two_surfaces(float near_range, float far_range, float near_share) {
  return {{far_range, 1.0F, 0.5F, 1.0F - near_share, 7}, {near_range, 1.0F, 0.5F, near_share, 3}};
}

// Check 13 of the specification: resolved surfaces give echoes at the true ranges with the right
// energy fractions.
TEST(Echoes, AreSeparateBeyondHalfPulseLength) {
  std::vector<RayHit> hits = two_surfaces(10.0F, 10.8F, 0.3F);
  const std::vector<Echo> echoes = form_echoes(hits, sees_all, beam);
  ASSERT_EQ(echoes.size(), 2U);
  EXPECT_EQ(echoes[0].range, 10.0F);
  EXPECT_EQ(echoes[1].range, 10.8F);
  EXPECT_FLOAT_EQ(echoes[0].intensity / echoes[1].intensity, 0.3F / 0.7F);
  EXPECT_EQ(echoes[0].triangle, 3U);
  EXPECT_EQ(echoes[1].triangle, 7U);
}

TEST(Echoes, MergeAtEnergyWeightedRangeWithinHalfPulseLength) {
  std::vector<RayHit> hits = two_surfaces(10.0F, 10.5F, 0.3F);
  const std::vector<Echo> echoes = form_echoes(hits, sees_all, beam);
  ASSERT_EQ(echoes.size(), 1U);
  EXPECT_FLOAT_EQ(echoes[0].range, 0.3F * 10.0F + 0.7F * 10.5F);
  EXPECT_EQ(echoes[0].triangle, 7U);  // triangle of the stronger part
}

TEST(Echoes, AreSelectedBySensorPolicy) {
  // Ranges 1 to 4 with energies 2, 4, 1, 3.
  const auto chosen = [](EchoChoice choice, int max) {
    std::vector<RayHit> hits = {
        {1, 1, 1, 0.2F, 0}, {2, 1, 1, 0.4F, 0}, {3, 1, 1, 0.1F, 0}, {4, 1, 1, 0.3F, 0}};
    Sensitivity sensitivity{.reference_range = 100.0};
    std::vector<float> ranges;
    Beam limited = beam;
    limited.max_returns = max;
    limited.choice = choice;
    for (const Echo& echo : form_echoes(hits, sensitivity, limited)) ranges.push_back(echo.range);
    return ranges;
  };
  using testing::ElementsAre;
  EXPECT_THAT(chosen(EchoChoice::first, 2), ElementsAre(1, 2));
  EXPECT_THAT(chosen(EchoChoice::last, 2), ElementsAre(3, 4));
  // Power decreases with the square of the range.
  EXPECT_THAT(chosen(EchoChoice::strongest, 1), ElementsAre(1));
  EXPECT_THAT(chosen(EchoChoice::strongest, 2), ElementsAre(1, 2));
  EXPECT_THAT(chosen(EchoChoice::strongest_and_last, 2), ElementsAre(1, 4));
  EXPECT_THAT(chosen(EchoChoice::strongest_and_last, 1), ElementsAre(1));
  EXPECT_THAT(chosen(EchoChoice::first, 9), ElementsAre(1, 2, 3, 4));
}

// Check 11: R_max = R_ref sqrt(rho cos / rho_ref). Ouster OS1: 40 m at 10% gives 113 m at 80%.
TEST(ReceivedPower, IsOneAtRangeOfLidarEquation) {
  const Sensitivity os1{.reference_range = 40.0, .reference_reflectance = 0.1};
  EXPECT_NEAR(received_power({113.137F, 1.0F, 0.8F, 1.0F, 0}, os1), 1.0, 1e-5);
  EXPECT_GT(received_power({113.0F, 1.0F, 0.8F, 1.0F, 0}, os1), 1.0F);
  EXPECT_LT(received_power({113.0F, 0.9F, 0.8F, 1.0F, 0}, os1), 1.0F);
  EXPECT_EQ(received_power({1e6F, 1.0F, 0.8F, 1.0F, 0}, sees_all),
            std::numeric_limits<float>::infinity());
  // Air that absorbs half of the light over 20 m in both directions.
  const Sensitivity hazy{40.0, 0.1, std::log(2.0) / 40.0};
  EXPECT_NEAR(received_power({20.0F, 1.0F, 0.1F, 1.0F, 0}, hazy), 2.0, 1e-5);
}

TEST(RangeSigma, IsRootOfSumOfSquares) {
  const RangeErrors errors{.sigma = 0.03, .sigma_per_metre = 0.004};
  EXPECT_FLOAT_EQ(range_sigma(errors, 10.0F, 1.0F, 0.4F), 0.05F);
  // D435: z^2 s / (f B) with s = 0.08 px, f = 424 px, B = 0.05 m is 15 mm at 2 m.
  const RangeErrors stereo{.sigma_per_square_metre = 0.08 / (424 * 0.05)};
  EXPECT_NEAR(range_sigma(stereo, 2.0F, 1.0F, 0.4F), 0.0151, 1e-4);
  const RangeErrors slanted{.sigma = 0.01, .incidence_power = 1.0};
  EXPECT_FLOAT_EQ(range_sigma(slanted, 10.0F, 0.5F, 0.4F), 0.02F);
  EXPECT_TRUE(std::isfinite(range_sigma(slanted, 10.0F, 0.0F, 0.4F)));
}

TEST(BeamSamples, MatchGaussianProfileUpToRadius) {
  const std::vector<BeamSample> samples = beam_samples(2);
  ASSERT_EQ(samples.size(), 19U);
  double total = 0.0, mean = 0.0, variance = 0.0;
  for (const BeamSample& sample : samples) {
    EXPECT_LE(std::hypot(sample.horizontal, sample.vertical), 1.0 + 1e-6);
    EXPECT_NEAR(sample.share / samples[0].share,
                std::exp(-2.0 * (std::pow(sample.horizontal, 2) + std::pow(sample.vertical, 2))),
                1e-5);
    total += sample.share;
    mean += sample.share * sample.horizontal;
    variance += sample.share * std::pow(sample.horizontal, 2);
  }
  EXPECT_NEAR(total, 1.0, 1e-6);
  EXPECT_NEAR(mean, 0.0, 1e-6);
  // The 1/e^2 radius of a Gaussian is two standard deviations. Truncated there, the variance of 1/4
  // is reduced to three quarters. The two rings give slightly more.
  EXPECT_GT(variance, 0.17);
  EXPECT_LT(variance, 0.25);
  EXPECT_EQ(beam_samples(0).size(), 1U);
}

}  // namespace
}  // namespace skycap::sim
