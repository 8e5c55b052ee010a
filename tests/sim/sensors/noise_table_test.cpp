// Range noise that depends on range, incidence and reflectance: the measured standard deviation on
// a tilted plane of known reflectance equals the interpolated table.

#include "sim/sensors/noise_table.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180.0;

/// Table in which each axis has an effect of its own.
NoiseTable make_table() {
  NoiseTable table;
  table.ranges = {2.0, 10.0, 30.0};
  table.incidences = {0.0, 45.0 * degree, 80.0 * degree};
  table.reflectances = {0.1, 0.5};
  for (const double range : {0.002, 0.01, 0.04}) {
    for (const double incidence : {1.0, 1.5, 4.0}) {
      for (const double reflectance : {2.0, 1.0}) {
        table.sigmas.push_back(range * incidence * reflectance);
      }
    }
  }
  return table;
}

double interpolated(double a, double b, double share) { return a + (b - a) * share; }

TEST(NoiseTable, ReturnsEntriesAtNodes) {
  const NoiseTable table = make_table();
  std::size_t i = 0;
  for (const double range : table.ranges) {
    for (const double incidence : table.incidences) {
      for (const double reflectance : table.reflectances) {
        EXPECT_NEAR(table.sigma(range, std::cos(incidence), reflectance), table.sigmas[i++], 1e-7);
      }
    }
  }
}

TEST(NoiseTable, InterpolatesAlongEachAxisAndEndsConstant) {
  const NoiseTable table = make_table();
  EXPECT_NEAR(table.sigma(6.0, 1.0, 0.5), interpolated(0.002, 0.01, 0.5), 1e-7);
  EXPECT_NEAR(table.sigma(10.0, std::cos(22.5 * degree), 0.5), 0.0125, 1e-7);
  EXPECT_NEAR(table.sigma(10.0, 1.0, 0.2), interpolated(0.02, 0.01, 0.25), 1e-7);
  EXPECT_NEAR(table.sigma(0.1, 1.0, 0.9), 0.002, 1e-7);
  EXPECT_NEAR(table.sigma(99.0, 0.0, 0.0), 0.04 * 4.0 * 2.0, 1e-7);
}

TEST(NoiseTable, AcceptsSingleEntry) {
  const NoiseTable table{{5.0}, {0.0}, {1.0}, {0.03}};
  table.validate("table");
  EXPECT_FLOAT_EQ(table.sigma(1.0, 0.3, 0.2), 0.03F);
}

TEST(NoiseTable, RejectsInvalidTables) {
  const auto message = [](NoiseTable table) {
    try {
      table.validate("errors.table");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("valid");
  };
  EXPECT_EQ(message(make_table()), "valid");
  NoiseTable table = make_table();
  table.sigmas.pop_back();
  EXPECT_THAT(message(table), testing::HasSubstr("errors.table.sigma lists 17 values"));
  table = make_table();
  table.ranges[1] = 50.0;
  EXPECT_THAT(message(table), testing::HasSubstr("errors.table.range must be in ascending order"));
  table = make_table();
  table.reflectances[1] = 1.5;
  EXPECT_THAT(message(table), testing::HasSubstr("errors.table.reflectance contains 1.5"));
  table = make_table();
  table.sigmas[3] = std::nan("");
  EXPECT_THAT(message(table), testing::HasSubstr("errors.table.sigma contains"));
}

/// Plane through (distance, 0, 0) whose normal is tilted by `tilt` from the x axis.
Scene make_wall(double distance, double tilt, float reflectance) {
  const Vector3d centre(distance, 0.0, 0.0), across(0.0, 1.0, 0.0),
      up(std::sin(tilt), 0.0, std::cos(tilt));
  constexpr double size = 200.0;
  geometry::Mesh mesh;
  for (const auto& [a, b] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
    mesh.vertices.push_back(centre + size * (a * across + b * up));
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<float> reflectances(2, reflectance);
  return {mesh, reflectances};
}

struct WallCase {
  double distance, tilt_deg;
  float reflectance;
};

class NoiseOfWall : public testing::TestWithParam<WallCase> {};

/// The standard deviation of n errors has the relative standard error 1 / sqrt(2 n).
void expect_deviation(const std::vector<double>& normalised) {
  ASSERT_GT(normalised.size(), 1000U);
  double mean = 0.0, squares = 0.0;
  for (const double error : normalised) mean += error;
  mean /= static_cast<double>(normalised.size());
  for (const double error : normalised) squares += (error - mean) * (error - mean);
  const auto count = static_cast<double>(normalised.size());
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 4.5 / std::sqrt(2.0 * count));
  EXPECT_NEAR(mean, 0.0, 4.5 / std::sqrt(count));
}

// Each error is divided by the standard deviation of the table for the geometry of its ray.
TEST_P(NoiseOfWall, OfLidarEqualsTable) {
  const auto [distance, tilt_deg, reflectance] = GetParam();
  const Scene scene = make_wall(distance, tilt_deg * degree, reflectance);
  const Vector3d normal(std::cos(tilt_deg * degree), 0.0, -std::sin(tilt_deg * degree));
  LidarConfig config;
  config.rotation_rate = 10.0;
  config.firing_period = 1e-4;
  config.channels = {{.elevation = 0.0}, {.elevation = 2.0 * degree}};
  config.field_of_view = 40.0 * degree;
  config.max_range = 150.0;
  config.errors.table = make_table();
  config.seed = 7;
  const Vector3d origin = Vector3d::Zero();
  const auto level = Eigen::Quaterniond::Identity();
  const Trajectory still({{0.0, origin, level}, {2.0, origin, level}});
  const Lidar lidar(config);
  const LidarReturns returns = lidar.measure(scene, {still, still}, {0, lidar.firings(still)});
  std::vector<double> errors;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Vector3d actual = returns.origin + returns.true_points[i].cast<double>(),
                   measured = returns.origin + returns.points[i].cast<double>();
    const double range = actual.norm(), cosine = std::abs(normal.dot(actual)) / range;
    errors.push_back((measured.norm() - range) /
                     config.errors.table.sigma(range, cosine, reflectance));
  }
  expect_deviation(errors);
}

TEST_P(NoiseOfWall, OfDepthCameraEqualsTable) {
  const auto [distance, tilt_deg, reflectance] = GetParam();
  const Scene scene = make_wall(distance, tilt_deg * degree, reflectance);
  const Vector3d normal(std::cos(tilt_deg * degree), 0.0, -std::sin(tilt_deg * degree));
  DepthCameraConfig config = d435();
  config.camera.max_range = 150.0;
  config.noise = {.seed = 7, .table = make_table()};
  DepthCameraConfig exact = config;
  exact.noise = {};
  const geometry::View view{Vector3d::Zero(), Vector3d::UnitX()};
  const geometry::Scan measured = DepthCamera(config).scan(scene, view, 3),
                       actual = DepthCamera(exact).scan(scene, view, 3);
  ASSERT_EQ(measured.pixels, actual.pixels);
  std::vector<double> errors;
  for (std::size_t i = 0; i < actual.points.size(); ++i) {
    const Vector3d point = actual.points[i].cast<double>();
    const double range = point.norm(), cosine = std::abs(normal.dot(point)) / range;
    const double error = (measured.points[i].cast<double>() - point).dot(point) / range;
    errors.push_back(error / config.noise.table.sigma(range, cosine, reflectance));
    // The noise is along the ray only.
    EXPECT_LT((measured.points[i].cast<double>().cross(point) / range).norm(), 1e-4 * range);
  }
  expect_deviation(errors);
}

INSTANTIATE_TEST_SUITE_P(Walls, NoiseOfWall,
                         testing::Values(WallCase{5.0, 0.0, 0.5F}, WallCase{5.0, 30.0, 0.1F},
                                         WallCase{20.0, 60.0, 0.3F}, WallCase{40.0, 10.0, 0.9F}));

}  // namespace
}  // namespace skycap::sim
