#include "flight/route/landing_surface.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::radians_per_degree;
using testing::HasSubstr;
using testing_support::thrown_message;

const Vector3d pad(12.0, -7.0, 3.0);

/// Plane `rise` above the pad, which descends to the south-west.
struct Plane {
  double slope_deg = 0.0;
  double rise = 0.0;

  double height(const Vector2d& at) const {
    const double along = (at - pad.head<2>()).dot(Vector2d(0.6, 0.8));
    return pad.z() + rise + std::tan(slope_deg * radians_per_degree) * along;
  }
};

std::vector<Vector3d> read_positions(const Plane& plane) {
  std::vector<Vector3d> positions;
  for (const Vector2d& at : landing_points(pad, 0.6)) {
    positions.emplace_back(at.x(), at.y(), plane.height(at));
  }
  return positions;
}

TEST(LandingSurface, ComputesSlopeAndRiseOfPlane) {
  for (const Plane& plane : {Plane{0.0, 0.0}, {7.0, 0.1}, {35.0, -0.8}}) {
    const auto ground = pad_ground(pad, read_positions(plane), GroundSource::terrain);
    ASSERT_TRUE(ground);
    EXPECT_NEAR(ground->slope, plane.slope_deg * radians_per_degree, 1e-12);
    EXPECT_NEAR(ground->rise, plane.rise, 1e-12);
    EXPECT_NEAR(ground->unevenness, 0.0, 1e-12);
    EXPECT_EQ(ground->position, pad);
  }
}

// A chequered pattern of steps with height 2 h deviates by h from its plane everywhere.
TEST(LandingSurface, ComputesUnevennessOfSteps) {
  std::vector<Vector3d> positions;
  for (int x = -4; x < 4; ++x) {
    for (int y = -4; y < 4; ++y) {
      const double step = (x + y) % 2 == 0 ? 0.05 : -0.05;
      positions.emplace_back(pad + Vector3d(0.5 + x, 0.5 + y, step));
    }
  }
  const auto ground = pad_ground(pad, positions, GroundSource::terrain);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->unevenness, 0.05, 1e-3);
}

TEST(LandingSurface, IsUnknownForFewCollinearOrNoisyPoints) {
  std::vector<Vector3d> positions = read_positions({5.0, 0.0});
  EXPECT_FALSE(pad_ground(pad, std::span(positions).first(5), GroundSource::measured));
  for (Vector3d& position : positions) position.y() = pad.y() + 2.0 * (position.x() - pad.x());
  EXPECT_FALSE(pad_ground(pad, positions, GroundSource::measured));

  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.2);
  positions = read_positions({5.0, 0.0});
  for (Vector3d& position : positions) position.z() += noise(random);
  EXPECT_FALSE(pad_ground(pad, positions, GroundSource::measured));
}

TEST(LandingSurface, IsUnsuitableWhenSteepUnevenOrOffset) {
  const PadLimits limits{10.0 * radians_per_degree, 0.0};
  const auto reason = [&](const LandingSurface& ground, const PadLimits& max) {
    return unfit_reason(ground, max);
  };
  LandingSurface ground{pad, 9.9 * radians_per_degree, 0.1, -0.29, GroundSource::measured};
  EXPECT_EQ(reason(ground, limits), "");
  ground.slope = 10.1 * radians_per_degree;
  EXPECT_THAT(reason(ground, limits),
              HasSubstr("has a slope of 10.1 degrees as measured; the maximum is 10.0"));
  ground.slope = 0.0;
  ground.unevenness = 0.31;
  EXPECT_THAT(reason(ground, limits), HasSubstr("has an unevenness of 0.310 m"));
  ground.unevenness = 0.0;
  ground.rise = -0.5;
  EXPECT_THAT(reason(ground, limits), HasSubstr("has ground 0.500 m below it as measured"));
  EXPECT_EQ(reason(ground, {limits.max_slope, 0.25}), "");
  EXPECT_THAT(thrown_message([&] { check_landing_surfaces(std::vector{ground}, limits); }),
              HasSubstr("the landing point at (12.00, -7.00, 3.00) has ground"));
}

// Noise of 3 cm on a ramp, with obstacles next to the pad and above it.
TEST(PadScan, MeasuresSlopeUnderNoiseAndIgnoresOtherPoints) {
  const Plane plane{12.0, 0.1};
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> spread(-3.0, 3.0);
  std::normal_distribution<double> noise(0.0, 0.03);
  PadScan scan(pad, 0.6);
  EXPECT_FALSE(scan.ground());
  for (int part = 0; part < 2; ++part) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 10'000; ++i) {
      const Vector2d at = pad.head<2>() + Vector2d{spread(random), spread(random)};
      const bool is_far = (at - pad.head<2>()).norm() > 0.7;
      const double height = is_far ? 20.0 : plane.height(at) + noise(random);
      points.push_back(Vector3d(at.x(), at.y(), height).cast<float>());
      points.push_back(Vector3d(at.x(), at.y(), pad.z() + 1.7).cast<float>());
    }
    scan.add_points(points);
  }
  const auto ground = scan.ground();
  ASSERT_TRUE(ground);
  EXPECT_EQ(ground->source, GroundSource::measured);
  // With 200 points per m^2, the standard error of the slope is 0.03 / (0.3 sqrt(600)), 0.2
  // degrees.
  EXPECT_NEAR(ground->slope, 12.0 * radians_per_degree, 1.0 * radians_per_degree);
  EXPECT_NEAR(ground->rise, 0.1, 0.01);
}

}  // namespace
}  // namespace skycap::flight
