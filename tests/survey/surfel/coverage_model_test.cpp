#include "survey/surfel/coverage_model.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace skycap::survey {
namespace {

constexpr double radius = 0.005;
constexpr double degree = std::numbers::pi / 180.0;

/// Simulates the uncovered fraction: a square grid of rays with a random offset hits the plane z =
/// 0, and each return is displaced by noise. The origin is covered if a return is close enough.
double simulated_uncovered_share(double ray_density, double incidence, const surfel::Noise& noise,
                                 int trials) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  const double cosine = std::cos(incidence), sine = std::sin(incidence);
  const double across = std::sqrt(cosine / ray_density), along = across / cosine;
  // Returns from farther away are in the ball with a probability below 1e-5.
  const double reach = radius + 4.5 * std::hypot(noise.isotropic, noise.along_ray);
  const int rows = static_cast<int>(reach / across) + 1;
  const int columns = static_cast<int>(reach / along) + 1;
  int uncovered = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const double u = uniform(generator), v = uniform(generator);
    bool is_covered = false;
    for (int i = -rows; i <= rows && !is_covered; ++i) {
      for (int j = -columns; j <= columns && !is_covered; ++j) {
        const double t = noise.along_ray * normal(generator);
        const double x = (i + u) * across + noise.isotropic * normal(generator);
        const double y = (j + v) * along + noise.isotropic * normal(generator) + t * sine;
        const double z = noise.isotropic * normal(generator) + t * cosine;
        is_covered = x * x + y * y + z * z < radius * radius;
      }
    }
    uncovered += is_covered ? 0 : 1;
  }
  return static_cast<double>(uncovered) / trials;
}

/// Returns four standard deviations of the simulated fraction, plus 0.02 for the interpolation of
/// the table.
double tolerance(double share, int trials) {
  return 4.0 * std::sqrt(share * (1.0 - share) / trials) + 0.02;
}

class CoverageModelAgainstSimulation : public testing::TestWithParam<double> {};

TEST_P(CoverageModelAgainstSimulation, MatchesForIsotropicNoiseAtEveryIncidence) {
  const surfel::Noise noise{.isotropic = GetParam() * radius};
  const surfel::CoverageModel coverage_model(radius, noise);
  constexpr int trials = 1500;
  for (const double degrees : {0.0, 30.0, 60.0, 75.0}) {
    for (const double rays : {0.3, 2.44}) {  // in r_d^2; 2.44: the depth camera at 1.98 m
      const double cosine = std::cos(degrees * degree);
      const double density = rays * cosine / (radius * radius);
      const double expected = simulated_uncovered_share(density, degrees * degree, noise, trials);
      const double share =
          std::exp(-coverage_model.hazard(static_cast<float>(density), static_cast<float>(cosine)));
      EXPECT_NEAR(share, expected, tolerance(expected, trials))
          << degrees << " degrees, " << rays << " rays";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(NoiseInCoverageRadii, CoverageModelAgainstSimulation,
                         testing::Values(0.0, 0.5, 1.0, 2.0, 4.0));

TEST(CoverageModel, MatchesSimulationForNoiseAlongRay) {
  const surfel::Noise noise{.along_ray = 2.0 * radius};
  const surfel::CoverageModel coverage_model(radius, noise);
  constexpr int trials = 4000;
  for (const double degrees : {0.0, 45.0, 75.0}) {
    const double cosine = std::cos(degrees * degree);
    const double density = 2.44 * cosine / (radius * radius);
    const double expected = simulated_uncovered_share(density, degrees * degree, noise, trials);
    const double share =
        std::exp(-coverage_model.hazard(static_cast<float>(density), static_cast<float>(cosine)));
    EXPECT_NEAR(share, expected, tolerance(expected, trials)) << degrees << " degrees";
  }
}

/// Simulates observations in which all points have the same displacement, with this standard
/// deviation along each axis.
double displaced_uncovered_share(double ray_density, const surfel::Noise& noise, double deviation,
                                 int observations) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  const double spacing = 1.0 / std::sqrt(ray_density);
  const int reach = static_cast<int>((radius + 4.5 * noise.isotropic) / spacing) + 1;
  int uncovered = 0;
  for (int observation = 0; observation < observations; ++observation) {
    const double u = uniform(generator), v = uniform(generator);
    // In the plane all offsets are equally likely.
    const double lift = deviation * normal(generator);
    bool is_covered = false;
    for (int i = -reach; i <= reach && !is_covered; ++i) {
      for (int j = -reach; j <= reach && !is_covered; ++j) {
        const double x = (i + u) * spacing + noise.isotropic * normal(generator);
        const double y = (j + v) * spacing + noise.isotropic * normal(generator);
        const double z = lift + noise.isotropic * normal(generator);
        is_covered = x * x + y * y + z * z < radius * radius;
      }
    }
    uncovered += is_covered ? 0 : 1;
  }
  return static_cast<double>(uncovered) / observations;
}

// A pose error displaces all points of an observation together, so many rays do not reduce its
// effect.
TEST(CoverageModel, MatchesSimulationForPoseErrors) {
  constexpr int observations = 4000;
  for (const double deviation : {0.5, 1.0, 3.0}) {
    for (const double sigma : {0.0, 0.5}) {
      surfel::Noise noise{.isotropic = sigma * radius};
      for (const double rays : {0.5, 8.0}) {
        const double density = rays / (radius * radius);
        const double expected =
            displaced_uncovered_share(density, noise, deviation * radius, observations);
        noise.position = deviation * radius;
        const surfel::CoverageModel coverage_model(radius, noise);
        const double share = std::exp(-coverage_model.hazard(static_cast<float>(density), 1.0F));
        EXPECT_NEAR(share, expected, tolerance(expected, observations))
            << deviation << " radii, noise " << sigma << ", " << rays << " rays";
      }
    }
  }
}

// 0.001 rad at 10 m is 1 cm across the ray. On a surface at grazing incidence all of it counts, on
// a frontal surface none.
TEST(CoverageModel, ScalesAngleErrorsWithDepthAcrossRay) {
  const surfel::Noise noise{.angle = 0.001};
  EXPECT_NEAR(noise.lateral_error(1.0, 10.0), 0.0, 1e-12);
  EXPECT_NEAR(noise.lateral_error(0.0, 10.0), 0.01, 1e-12);
  EXPECT_NEAR(noise.lateral_error(std::cos(30.0 * degree), 20.0), 0.01, 1e-12);
  constexpr double spacing = 0.0001;  // ray spacing at 1 m
  const surfel::CoverageModel exact(radius, {}, spacing), turned(radius, noise, spacing);
  const auto density = [](double depth) {
    return static_cast<float>(0.5 / std::pow(spacing * depth, 2));
  };
  EXPECT_EQ(turned.hazard(density(20.0), 1.0F), exact.hazard(density(20.0), 1.0F));
  EXPECT_LT(turned.hazard(density(20.0), 0.5F), 0.9F * exact.hazard(density(20.0), 0.5F));
}

// Discs of radius r_d around a grid with spacing s cover the plane if s <= r_d sqrt(2). If they do
// not touch, they cover pi r_d^2 / s^2 of it.
TEST(CoverageModel, MatchesDiscCoverageWithoutNoise) {
  const surfel::CoverageModel coverage_model(radius, {});
  EXPECT_EQ(coverage_model.hazard(static_cast<float>(1.0 / (radius * radius)), 1.0F),
            surfel::CoverageModel::max_hazard);
  const double sparse = 0.125;  // rays in r_d^2: s = 2.8 r_d
  EXPECT_NEAR(
      1.0 - std::exp(-coverage_model.hazard(static_cast<float>(sparse / (radius * radius)), 1.0F)),
      std::numbers::pi * sparse, 0.02);  // 64 samples of the grid offset
}

TEST(CoverageModel, IncreasesFromZeroWithRayDensity) {
  const surfel::CoverageModel coverage_model(radius, {.isotropic = 0.01});
  EXPECT_EQ(coverage_model.hazard(0.0F, 1.0F), 0.0F);
  float before = 0.0F;
  for (float density = 100.0F; density < 3e6F; density *= 1.3F) {
    const float hazard = coverage_model.hazard(density, 0.7F);
    EXPECT_GE(hazard, before) << density;
    before = hazard;
  }
  EXPECT_LE(before, surfel::CoverageModel::max_hazard);
}

// Rays are 1 mm apart at 1 m, so their spacing determines the depth. The observation uses the noise
// at that depth.
TEST(CoverageModel, DerivesDepthOfGrowingNoiseFromRaySpacing) {
  constexpr double ball = 0.02, spacing = 0.001;
  const surfel::Noise noise{.isotropic = 0.01, .growing = 1.0, .depth = 10.0};
  const surfel::CoverageModel growing(ball, noise, spacing);
  for (const double depth : {5.0, 10.0, 14.0}) {
    const double sigma = 0.01 * depth * depth / 100.0;
    EXPECT_NEAR(noise.at(depth).across(1.0), sigma, 1e-12);
    const surfel::CoverageModel constant(ball, {.isotropic = sigma});
    const auto density = static_cast<float>(1.0 / std::pow(spacing * depth, 2));
    const float expected = constant.hazard(density, 1.0F);
    // Between two nodes of the table the noise varies as well.
    EXPECT_NEAR(growing.hazard(density, 1.0F), expected, 0.12F * expected) << depth;
  }
}

}  // namespace
}  // namespace skycap::survey
