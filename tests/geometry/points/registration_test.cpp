#include "geometry/points/registration.h"

#include <cmath>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"

namespace skycap::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double radius = 0.1;
const Vector3d sensor(2.0, 2.5, 2.2);

/// Returns three random numbers, drawn in the order z, y, x. The order must not change, because
/// results depend on the seed.
template <typename Distribution>
Vector3d drawn(Distribution& distribution, std::mt19937_64& random) {
  const double z = distribution(random), y = distribution(random), x = distribution(random);
  return {x, y, z};
}

/// Adds points of a 2 m square in the corner, perpendicular to the axis `across`.
void add_square(int across, std::mt19937_64& random, double noise, std::vector<Vector3f>& points) {
  std::uniform_real_distribution<double> coordinate(0.0, 2.0);
  std::normal_distribution<double> error(0.0, 1.0);
  for (int i = 0; i < 12'000; ++i) {
    Vector3d point = drawn(coordinate, random);
    point[across] = 0.0;
    points.emplace_back((point + noise * drawn(error, random)).cast<float>());
  }
}

/// Returns measured points of squares perpendicular to these axes.
std::vector<Vector3f> squares(const std::vector<int>& across, std::uint64_t seed, double noise) {
  std::mt19937_64 random(seed);
  std::vector<Vector3f> points;
  for (const int axis : across) add_square(axis, random, noise, points);
  return points;
}

/// Returns a random pose error of 10 cm and 1 degree.
Isometry3d make_error(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> number;
  const Vector3d axis = drawn(number, random).normalized(),
                 direction = drawn(number, random).normalized();
  Isometry3d error = Isometry3d::Identity();
  error.linear() = Eigen::AngleAxisd(radians_per_degree, axis).toRotationMatrix();
  error.translation() = sensor + 0.1 * direction - error.linear() * sensor;
  return error;
}

struct Outcome {
  Registration found;
  Isometry3d rest = Isometry3d::Identity();  ///< remaining error after the correction
  double shift() const { return (rest * sensor - sensor).norm(); }
  double turn_deg() const { return Eigen::AngleAxisd(rest.linear()).angle() / radians_per_degree; }
};

Outcome registered(const std::vector<int>& across, const Isometry3d& error, std::uint64_t seed,
                   double noise) {
  SurfaceMap map(radius);
  map.add(squares(across, 2 * seed, noise), sensor);
  Scan scan;
  scan.world_from_sensor.translation() = error * sensor;
  for (const Vector3f& point : squares(across, 2 * seed + 1, noise)) {
    scan.points.emplace_back((error * point.cast<double>()).cast<float>());
  }
  const ScanPatches patches = scan_patches(scan, radius, 100'000, 1500);
  Outcome outcome{.found = register_scan(patches.patches, map, 4.0 * radius, 50)};
  outcome.rest = outcome.found.correction * error;
  return outcome;
}

int observable(const Registration& found) {
  return static_cast<int>(std::ranges::count_if(
      found.directions, [](const RigidDirection& d) { return d.is_observable(); }));
}

/// This includes the case in which one square is off by 13 cm and the other two already fit (seed
/// 11).
TEST(Registration, CorrectsAllErrorsInCorner) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    for (const double noise : {0.0, 0.01, 0.02}) {
      const Outcome outcome = registered({0, 1, 2}, make_error(seed), seed, noise);
      EXPECT_EQ(observable(outcome.found), 6);
      EXPECT_LT(outcome.shift(), 0.01) << "seed " << seed << ", noise " << noise;
      EXPECT_LT(outcome.turn_deg(), noise < 0.02 ? 0.1 : 0.2) << seed << ", noise " << noise;
      EXPECT_GT(outcome.found.first_error, 0.01);
    }
  }
}

/// One wall determines its distance and its two tilts, and nothing else.
TEST(Registration, CorrectsOnlyObservableDirectionsOfPlane) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Outcome outcome = registered({2}, make_error(seed), seed, 0.01);
    ASSERT_EQ(observable(outcome.found), 3) << seed;
    const Isometry3d& rest = outcome.rest;
    // The plane is corrected: its middle has the right height and its normal is vertical.
    EXPECT_NEAR((rest * Vector3d(1.0, 1.0, 0.0)).z(), 0.0, 0.003);
    EXPECT_LT(std::acos(std::min(1.0, rest.linear()(2, 2))) / radians_per_degree, 0.1);
    // The components along the plane are not corrected.
    const Vector3d moved = outcome.found.correction * outcome.found.middle - outcome.found.middle;
    EXPECT_LT(moved.head<2>().norm(), 0.005) << moved.transpose();
    EXPECT_LT(std::abs(Eigen::AngleAxisd(outcome.found.correction.linear()).axis().z()), 0.2);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(outcome.found.directions[k].information, 0.01);
      EXPECT_LT(std::abs(outcome.found.directions[k].amount), 0.005);
    }
  }
}

/// In the groove between two planes, the scan can slide along the edge.
TEST(Registration, ReportsUnobservableDirectionAlongEdge) {
  const Outcome outcome = registered({0, 2}, make_error(3), 3, 0.01);
  ASSERT_EQ(observable(outcome.found), 5);
  EXPECT_GT(std::abs(outcome.found.directions[0].displacement.y()), 0.95);
}

TEST(Registration, KeepsCorrectPose) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Outcome outcome = registered({0, 1, 2}, Isometry3d::Identity(), seed, 0.01);
    EXPECT_LT(outcome.shift(), 0.003);
    EXPECT_LT(outcome.turn_deg(), 0.05);
  }
}

TEST(Registration, ReturnsIdentityWithoutOverlap) {
  Isometry3d far_off = Isometry3d::Identity();
  far_off.translation() = Vector3d(9.0, 9.0, 9.0);
  const Outcome outcome = registered({0, 1, 2}, far_off, 1, 0.01);
  EXPECT_LT(outcome.found.matches, 50U);
  EXPECT_TRUE(outcome.found.correction.isApprox(Isometry3d::Identity(), 0.0));
}

TEST(SurfaceMap, SeparatesSidesOfThinWall) {
  SurfaceMap map(radius);
  std::vector<Vector3f> above = squares({2}, 1, 0.001), below = squares({2}, 2, 0.001);
  for (Vector3f& point : above) point.z() += 0.03F;
  map.add(above, sensor);
  map.add(below, {1.0, 1.0, -3.0});
  const SurfacePatch up{{1.0, 1.0, 0.02}, Vector3d::UnitZ(), 0.0};
  const SurfacePatch down{{1.0, 1.0, 0.02}, -Vector3d::UnitZ(), 0.0};
  const SurfacePatch* found = map.nearest(up, 0.2);
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->mean.z(), 0.03, 0.002);
  EXPECT_GT(found->normal.z(), 0.99);
  found = map.nearest(down, 0.2);
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->mean.z(), 0.0, 0.002);
  EXPECT_EQ(map.nearest({{1.0, 1.0, 0.02}, Vector3d::UnitX(), 0.0}, 0.2), nullptr);
}

TEST(FitPatch, AcceptsOnlyPlanes) {
  std::vector<Vector3f> line, blob;
  std::mt19937_64 random(1);
  std::normal_distribution<float> number(0.0F, 0.1F);
  for (int i = 0; i < 50; ++i) {
    line.emplace_back(0.01F * static_cast<float>(i), 0.0F, 0.0F);
    blob.push_back({number(random), number(random), number(random)});
  }
  EXPECT_FALSE(fit_patch(line, sensor));
  EXPECT_FALSE(fit_patch(blob, sensor));
  const std::vector<Vector3f> plane = squares({2}, 1, 0.01);
  const auto patch = fit_patch(plane, sensor);
  ASSERT_TRUE(patch);
  EXPECT_NEAR(patch->deviation, 0.01, 0.0005);
  EXPECT_GT(patch->normal.z(), 0.999);
  EXPECT_FALSE(fit_patch(std::span(plane).first(7), sensor));
}

}  // namespace
}  // namespace skycap::geometry
