#include "missions/evaluation/coverage.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/points/point_grid.h"
#include "tests/support/clouds.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Returns evenly distributed samples of the unit sphere.
std::vector<Vector3f> sphere(std::size_t count) {
  std::vector<Vector3f> points;
  for (const Vector3d& direction : evaluation::fibonacci_directions(count)) {
    points.push_back(direction.cast<float>());
  }
  return points;
}

// Brute-force reference. The search cells are 2 r_d wide. Coordinates of both signs and a shift far
// from the origin test their borders.
TEST(CoverageMeter, MatchesBruteForce) {
  for (const float shift : {0.0F, 40.0F}) {
    std::vector<Vector3f> samples = tests::random_points(2000, 1.0, 1);
    std::vector<Vector3f> points = tests::random_points(300, 1.0, 2);
    for (Vector3f& p : samples) p.x() += shift;
    for (Vector3f& p : points) p.x() += shift;
    constexpr double distance = 0.1;
    evaluation::CoverageMeter meter(samples, distance);
    meter.add(std::span(points).first(100));
    meter.add(std::span(points).subspan(100));

    std::size_t covered = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      bool is_covered = false;
      for (const Vector3f& point : points) {
        is_covered |= geometry::squared_distance(samples[i], point) <=
                      static_cast<float>(distance * distance);
      }
      ASSERT_EQ(meter.is_covered()[i], is_covered ? 1 : 0) << "sample " << i;
      covered += is_covered;
    }
    EXPECT_EQ(meter.share(), static_cast<double>(covered) / 2000.0);
    EXPECT_GT(covered, 100U);  // otherwise the test would compare nothing
    EXPECT_LT(covered, 1900U);
  }
}

// Measurements on the upper half of the unit sphere reach beyond its edge by an arc with chord r_d.
// They cover samples with z >= -sin(2 asin(r_d / 2)), a fraction of (1 + sin(...)) / 2.
TEST(CoverageMeter, CoversMeasuredHemisphereAndRim) {
  constexpr double distance = 0.2;
  std::vector<Vector3f> measured;
  for (const Vector3f& point : sphere(200'000)) {
    if (point.z() >= 0.0F) measured.push_back(point);
  }
  evaluation::CoverageMeter meter(sphere(50'000), distance);
  meter.add(measured);
  const double rim = std::sin(2.0 * std::asin(0.5 * distance));
  // 50,000 even samples resolve the fraction to about one row of samples at the rim, 0.1%.
  EXPECT_NEAR(meter.share(), 0.5 * (1.0 + rim), 1e-3);
}

TEST(CoverageMeter, ComputesCoverageOfMarkedSamplesOnly) {
  const std::vector<Vector3f> samples{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  evaluation::CoverageMeter meter(samples, 0.1);
  meter.add(std::vector<Vector3f>{{0, 0, 0.05F}, {2, 0, 0}});
  const std::vector<std::uint8_t> last_two{0, 1, 1}, none{0, 0, 0};
  EXPECT_EQ(evaluation::covered_share(meter.is_covered(), last_two), 0.5);
  EXPECT_EQ(evaluation::covered_share(meter.is_covered(), none), std::nullopt);
}

TEST(FibonacciDirections, AreUnitVectorsAndSpreadEvenly) {
  constexpr std::size_t count = 1000;
  const auto directions = evaluation::fibonacci_directions(count);
  ASSERT_EQ(directions.size(), count);
  Vector3d sum = Vector3d::Zero();
  double nearest_pair = 4.0;
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(directions[i].norm(), 1.0, 1e-12);
    sum += directions[i];
    for (std::size_t j = 0; j < i; ++j) {
      nearest_pair = std::min(nearest_pair, (directions[i] - directions[j]).norm());
    }
  }
  EXPECT_LT(sum.norm() / count, 1e-3);
  // A hexagonal packing of the sphere has a spacing of sqrt(8 pi / (sqrt(3) n)). The lattice
  // reaches more than 80% of it.
  EXPECT_GT(nearest_pair, 0.8 * std::sqrt(8.0 * std::numbers::pi / (std::sqrt(3.0) * count)));
}

}  // namespace
}  // namespace skycap::missions
