#include "geometry/points/m3c2.h"

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Cloud = std::vector<Vector3f>;

/// Plane z = height of a square with the given side and point spacing, rotated by `turn`.
Cloud make_plane(double height, double sigma, double spacing, std::uint64_t seed,
                 const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> jitter(-0.5 * spacing, 0.5 * spacing);
  constexpr double half = 2.0;
  Cloud cloud;
  for (double x = -half; x <= half; x += spacing) {
    for (double y = -half; y <= half; y += spacing) {
      const double dx = jitter(random), dy = jitter(random), dz = normal(random);
      cloud.push_back((turn * Vector3d(x + dx, y + dy, height + sigma * dz)).cast<float>());
    }
  }
  return cloud;
}

/// Core points away from the edges of the plane.
Cloud make_cores(const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
  Cloud cores;
  for (double x = -1.2; x <= 1.2; x += 0.3) {
    for (double y = -1.2; y <= 1.2; y += 0.3) {
      cores.push_back((turn * Vector3d(x, y, 0.0)).cast<float>());
    }
  }
  return cores;
}

constexpr M3c2Options options{
    .normal_scale = 1.0, .cylinder_diameter = 0.6, .max_distance = 1.0, .registration_error = 0.0};
const Vector3d below(0.0, 0.0, -100.0);

class M3c2Planes : public testing::TestWithParam<double> {};

// The mean of n projections with standard deviation s has the standard error s / sqrt(n). The
// tolerance of a single core point is five standard errors of both means; the mean over 81 core
// points must be within 1 mm.
TEST_P(M3c2Planes, MeasuresKnownOffset) {
  const double offset = GetParam();
  constexpr double sigma1 = 0.004, sigma2 = 0.008, spacing = 0.02;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Vector3d(1.0, 2.0, 0.5).normalized()));
  const Cloud first = make_plane(0.0, sigma1, spacing, 1, turn),
              second = make_plane(offset, sigma2, spacing, 2, turn), cores = make_cores(turn);
  const auto distances = m3c2_distances(cores, first, second, turn * below, options, 2);
  ASSERT_EQ(distances.size(), cores.size());
  double mean = 0.0;
  const double pi = 3.14159265358979;
  const double expected_points = pi * 0.3 * 0.3 / (spacing * spacing);
  // Closed form of the level of detection.
  const double level = 1.96 * std::sqrt((sigma1 * sigma1 + sigma2 * sigma2) / expected_points);
  for (const M3c2Distance& distance : distances) {
    ASSERT_TRUE(distance.is_known());
    EXPECT_NEAR(distance.distance, offset, 5.0 / 1.96 * level);
    EXPECT_NEAR(distance.level_of_detection, level, 0.1 * level);
    EXPECT_NEAR(distance.deviation1, sigma1, 0.1 * sigma1);
    EXPECT_NEAR(distance.deviation2, sigma2, 0.1 * sigma2);
    EXPECT_NEAR(static_cast<double>(distance.points1), expected_points, 0.1 * expected_points);
    EXPECT_GT(distance.normal.dot(turn * Vector3d::UnitZ()), 0.999);
    mean += distance.distance / static_cast<double>(distances.size());
    EXPECT_EQ(distance.is_significant(), std::abs(distance.distance) > distance.level_of_detection);
  }
  EXPECT_NEAR(mean, offset, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Offsets, M3c2Planes, testing::Values(-0.5, -0.01, 0.0, 0.003, 0.08, 0.7));

// At 95% confidence, 5% of the distances between equal planes are beyond the level of detection.
// The bounds are four standard deviations of the binomial distribution.
TEST(M3c2, FindsChangeInFivePercentOfUnchangedSurface) {
  std::size_t significant = 0, all = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Cloud first = make_plane(0.0, 0.01, 0.03, 2 * seed),
                second = make_plane(0.0, 0.01, 0.03, 2 * seed + 1);
    M3c2Options separate = options;  // cylinders that do not share points
    separate.cylinder_diameter = 0.28;
    separate.normal_scale = 3.0;
    for (const auto& distance : m3c2_distances(make_cores(), first, second, below, separate, 1)) {
      significant += distance.is_significant() ? 1 : 0;
      ++all;
    }
  }
  const double share = static_cast<double>(significant) / static_cast<double>(all);
  const double deviation = std::sqrt(0.05 * 0.95 / static_cast<double>(all));
  EXPECT_NEAR(share, 0.05, 4.0 * deviation + 0.01);
}

TEST(M3c2, AddsRegistrationErrorToLevelOfDetection) {
  const Cloud first = make_plane(0.0, 0.01, 0.05, 1), second = make_plane(0.1, 0.01, 0.05, 2);
  M3c2Options registered = options;
  registered.registration_error = 0.02;
  const auto without = m3c2_distances(make_cores(), first, second, below, options, 1);
  const auto with = m3c2_distances(make_cores(), first, second, below, registered, 1);
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_NEAR(with[i].level_of_detection, without[i].level_of_detection + 1.96 * 0.02, 1e-12);
    EXPECT_EQ(with[i].distance, without[i].distance);
  }
}

TEST(M3c2, LeavesDistanceUnknownWithoutCounterpart) {
  const Cloud first = make_plane(0.0, 0.0, 0.05, 1), second = make_plane(1.5, 0.0, 0.05, 2);
  for (const auto& distance : m3c2_distances(make_cores(), first, second, below, options, 1)) {
    EXPECT_FALSE(distance.is_known());
    EXPECT_FALSE(distance.is_significant());
    EXPECT_GT(distance.points1, 0U);
    EXPECT_EQ(distance.points2, 0U);
  }
}

/// Twin that tests every point against every cylinder, in double precision.
M3c2Distance brute_force(const Vector3f& core_point, const Cloud& first, const Cloud& second,
                         const Vector3d& centre, const M3c2Options& with) {
  const Vector3d core = core_point.cast<double>();
  std::vector<Vector3d> near;
  for (const Vector3f& point : first) {
    if ((point - core_point).squaredNorm() <=
        static_cast<float>(0.25 * with.normal_scale * with.normal_scale)) {
      near.push_back(point.cast<double>());
    }
  }
  M3c2Distance result;
  if (near.size() < 3) return result;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : near) mean += point / static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3d& point : near) covariance += (point - mean) * (point - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  result.normal = solver.eigenvectors().col(0);
  if (result.normal.dot(core - centre) < 0.0) result.normal = -result.normal;
  const auto heights = [&](const Cloud& cloud) {
    std::vector<double> found;
    for (const Vector3f& point : cloud) {
      const Vector3d offset = point.cast<double>() - core;
      const double height = offset.dot(result.normal);
      const double across = offset.cross(result.normal).norm();
      if (std::abs(height) <= with.max_distance && across <= with.cylinder_diameter / 2.0) {
        found.push_back(height);
      }
    }
    return found;
  };
  const std::vector<double> one = heights(first), two = heights(second);
  result.points1 = one.size();
  result.points2 = two.size();
  if (std::min(one.size(), two.size()) < with.min_points) return result;
  const auto statistics = [](const std::vector<double>& values) {
    double sum = 0.0, squares = 0.0;
    for (const double value : values) sum += value;
    sum /= static_cast<double>(values.size());
    for (const double value : values) squares += (value - sum) * (value - sum);
    return std::pair(sum, squares / static_cast<double>(values.size() - 1));
  };
  const auto [mean1, variance1] = statistics(one);
  const auto [mean2, variance2] = statistics(two);
  result.distance = mean2 - mean1;
  result.level_of_detection = 1.96 * (std::sqrt(variance1 / static_cast<double>(one.size()) +
                                                variance2 / static_cast<double>(two.size())) +
                                      with.registration_error);
  return result;
}

/// Rough surface with edges and holes.
Cloud make_rough(std::uint64_t seed, double shift) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  std::normal_distribution<double> noise(0.0, 0.01);
  Cloud cloud;
  while (cloud.size() < 6000) {
    const double x = place(random), y = place(random), z = noise(random);
    if (x * x + y * y < 0.3) continue;
    const double step = x > 1.0 ? 0.6 : 0.0;
    cloud.push_back(Vector3d(x, y, 0.2 * std::sin(2.0 * x) * y + step + shift + z).cast<float>());
  }
  return cloud;
}

// Points on the border of a cylinder may belong to it or not, depending on rounding; there are
// none in these clouds. Distances must agree within 1 µm.
TEST(M3c2, EqualsBruteForceOnRoughSurface) {
  const Cloud first = make_rough(1, 0.0), second = make_rough(2, 0.05);
  const Cloud cores(first.begin(), first.begin() + 500);
  for (const double length : {0.2, 0.5, 1.7}) {
    for (const double diameter : {0.15, 0.4}) {
      M3c2Options with = options;
      with.max_distance = length;
      with.cylinder_diameter = diameter;
      with.normal_scale = 0.8;
      with.registration_error = 0.003;
      const auto distances = m3c2_distances(cores, first, second, below, with, 3);
      std::size_t known = 0;
      for (std::size_t i = 0; i < cores.size(); ++i) {
        const M3c2Distance expected = brute_force(cores[i], first, second, below, with);
        ASSERT_EQ(distances[i].points1, expected.points1) << i;
        ASSERT_EQ(distances[i].points2, expected.points2) << i;
        ASSERT_EQ(distances[i].is_known(), expected.is_known()) << i;
        if (!expected.is_known()) continue;
        ++known;
        ASSERT_NEAR(distances[i].distance, expected.distance, 1e-6) << i;
        ASSERT_NEAR(distances[i].level_of_detection, expected.level_of_detection, 1e-6) << i;
      }
      EXPECT_GT(known, diameter > 0.3 ? 400U : 50U);
    }
  }
}

TEST(M3c2, DoesNotDependOnThreads) {
  const Cloud first = make_rough(1, 0.0), second = make_rough(2, 0.05);
  const auto one = m3c2_distances(first, first, second, below, options, 1),
             four = m3c2_distances(first, first, second, below, options, 4);
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].points2, four[i].points2);
    if (one[i].is_known()) {
      ASSERT_EQ(one[i].distance, four[i].distance);
    }
  }
}

TEST(M3c2, RejectsInvalidOptions) {
  for (double M3c2Options::*const field :
       {&M3c2Options::normal_scale, &M3c2Options::cylinder_diameter, &M3c2Options::max_distance}) {
    for (const double value : {0.0, -1.0, std::nan(""), 1e9}) {
      M3c2Options with = options;
      with.*field = value;
      EXPECT_THROW(with.validate(), Error);
    }
  }
  M3c2Options with = options;
  with.max_distance = 501.0 * with.cylinder_diameter;
  EXPECT_THROW(with.validate(), Error);
}

}  // namespace
}  // namespace skycap::geometry
