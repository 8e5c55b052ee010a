#include "sim/sensors/survey_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/pose/camera.h"
#include "geometry/pose/platform.h"
#include "sim/sensors/scanner_field.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double degree = std::numbers::pi / 180.0;

/// Returns a scanner with 40 lasers 1 degree apart, the lowest at -25 degrees, and 1 degree between
/// firings.
LidarConfig scanner() {
  LidarConfig lidar;
  lidar.rotation_rate = 10.0;
  lidar.firing_period = 1.0 / 3600.0;
  lidar.channels.clear();
  for (int i = 0; i < 40; ++i) lidar.channels.push_back({.elevation = (i - 25) * degree});
  return lidar;
}

/// Returns the walls of a room of 20 m, seen from inside.
geometry::Mesh room() {
  geometry::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? 10 : -10, (i & 2) != 0 ? 10 : -10,
                               (i & 4) != 0 ? 10 : -10);
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 7, 5}, {4, 6, 7}, {0, 5, 1}, {0, 4, 5},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

SurveySensor make_sensor(const LidarConfig& lidar) {
  SurveySensorOptions config;
  config.scanner = lidar;
  return SurveySensor(config, 1);
}

TEST(SurveySensor, MeasuresAllAroundWithoutPixelsForStationaryScanner) {
  const Scene scene(room());
  const geometry::View view = geometry::look_at({1, 2, 3}, {9, 4, 1});
  const geometry::Scan scan = make_sensor(scanner()).scan(scene, view, 0, 1);
  EXPECT_EQ(scan.points.size(), 360U * 40U);
  EXPECT_TRUE(scan.pixels.empty());
  EXPECT_LT((geometry::to_view(scan.world_from_sensor).direction - view.direction).norm(), 1e-12);
  for (const Vector3f& point : scan.points) {
    EXPECT_NEAR(point.cwiseAbs().maxCoeff(), 10.0F, 1e-4F);
  }
}

// The planner assumes that the scanner has as many rays as the forward camera, in the same
// directions.
TEST(SurveySensor, MatchesScannerRaysInForwardCamera) {
  const Scene scene(room());
  const geometry::View view = geometry::look_at({1, 2, 3}, {9, 4, 1});
  const geometry::Scan scan = make_sensor(scanner()).scan(scene, view, 0, 1);
  const geometry::Camera camera(forward_camera(scanner()).camera);
  EXPECT_NEAR(camera.config().horizontal_fov, 90.0 * degree, 1e-12);
  EXPECT_NEAR(camera.config().vertical_fov, 40.0 * degree, 1e-12);

  const Eigen::Isometry3d camera_from_world = scan.world_from_sensor.inverse();
  int in_view = 0, in_middle = 0;
  double max_elevation = 0.0, min_elevation = 0.0;
  for (const Vector3f& point : scan.points) {
    const Vector3d in_camera = camera_from_world * point.cast<double>();
    const auto pixel = camera.project(in_camera);
    if (!pixel) continue;
    ++in_view;
    max_elevation = std::max(max_elevation, std::atan2(-in_camera.y(), in_camera.z()));
    min_elevation = std::min(min_elevation, std::atan2(-in_camera.y(), in_camera.z()));
    const Eigen::Vector2d off = (*pixel - camera.principal_point_px()).cwiseAbs();
    in_middle += off.x() < 0.125 * camera.width() && off.y() < 0.25 * camera.height() ? 1 : 0;
  }
  // Lasers from -19.5 to 19.5 degrees around the axis form cones. Image rows form planes.
  EXPECT_NEAR(max_elevation, 20.0 * degree, 0.6 * degree);
  EXPECT_NEAR(min_elevation, -20.0 * degree, 0.6 * degree);
  const double pixels = static_cast<double>(camera.width()) * camera.height();
  // An eighth of the image, where rays and pixels have the same density, except for rounding by a
  // quarter of about 40 rows and columns.
  EXPECT_NEAR(in_middle, pixels / 8.0, 0.12 * pixels / 8.0);
  // At azimuth a, the upper image edge has the elevation atan(tan(20) cos(a)). Rays are 1 degree
  // apart in both directions. The cones of the lasers, tilted by 5.5 degrees, deviate by some
  // percent.
  double rays = 0.0;
  for (int a = -45; a < 45; ++a) {
    rays += 2.0 / degree * std::atan(std::tan(20.0 * degree) * std::cos((a + 0.5) * degree));
  }
  EXPECT_NEAR(in_view, rays, 0.03 * rays);
}

TEST(SurveySensor, DependsOnSeedAndFrameButNotOnThreadCount) {
  const Scene scene(room());
  const geometry::View view{{0, 0, 0}, {1, 0, 0}};
  LidarConfig lidar = scanner();
  lidar.errors.sigma = 0.02;
  const SurveySensor sensor = make_sensor(lidar);
  const geometry::Scan scan = sensor.scan(scene, view, 3, 1);
  EXPECT_EQ(scan.points, sensor.scan(scene, view, 3, 3, scan).points);
  EXPECT_NE(scan.points, sensor.scan(scene, view, 4, 1).points);
  EXPECT_EQ(scan.points.size(), sensor.scan(scene, view, 4, 1).points.size());
}

/// Returns a level mount with the rotation axis along the flight direction, or to the left across
/// it.
geometry::ScannerMount level_mount(double azimuth) {
  return scanner_mount(scanner(),
                       Eigen::Isometry3d(Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) *
                                         Eigen::AngleAxisd(90.0 * degree, Vector3d::UnitY())));
}

TEST(MountedScanner, LooksLeftOfItsAxisForAnyHeading) {
  const geometry::View north{{1, 2, 3}, {0, 1, 0}};
  const geometry::View west = geometry::scanner_view(level_mount(0.0), north);
  EXPECT_LT((west.direction - Vector3d(-1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(west.position, north.position);
  const geometry::View south = geometry::scanner_view(level_mount(90.0 * degree), north);
  EXPECT_LT((south.direction - Vector3d(0, -1, 0)).norm(), 1e-12);
  for (const double azimuth : {0.0, 0.7, -2.0}) {
    const geometry::ScannerMount mount = level_mount(azimuth);
    EXPECT_LT((geometry::nose_view(mount, geometry::scanner_view(mount, north)).direction -
               north.direction)
                  .norm(),
              1e-12);
    // The pitch of a view does not change the heading.
    geometry::View steep = geometry::scanner_view(mount, north);
    steep.direction = (steep.direction - 5.0 * Vector3d::UnitZ()).normalized();
    EXPECT_LT((geometry::nose_view(mount, steep).direction - north.direction).norm(), 1e-12);
  }
}

// A scan in flight represents the surrounding revolutions: all rays are in the ring around the
// axis.
TEST(MountedScanner, SweepsRingOnceForEachRevolutionOfPeriod) {
  const Scene scene(room());
  SurveySensorOptions config;
  config.scanner = scanner();
  config.mount = level_mount(0.0);
  config.capture = Capture::moving;
  config.frame_period = 0.5;  // five revolutions
  const SurveySensor sensor(config, 1);
  const geometry::View view = geometry::scanner_view(*config.mount, {{1, 2, 3}, {0.6, 0.8, 0}});
  const geometry::Scan scan = sensor.scan(scene, view, 0, 1);
  EXPECT_EQ(scan.points.size(), 5U * 360U * 40U);
  const Vector3d axis(0.6, 0.8, 0.0);
  double ahead = -1.0, behind = 1.0;
  for (const Vector3f& point : scan.points) {
    const double sine = (point.cast<double>() - view.position).normalized().dot(axis);
    ahead = std::max(ahead, sine), behind = std::min(behind, sine);
  }
  // Lasers from -25 to 14 degrees. Revolutions start up to 13 cm away from the scan position, at
  // least 7 m from the walls.
  EXPECT_NEAR(std::asin(ahead), 14.0 * degree, 1.1 * degree);
  EXPECT_NEAR(std::asin(behind), -25.0 * degree, 1.1 * degree);
}

// The planner's camera is within the ring.
TEST(MountedScanner, HasSideCameraInsideScannedRing) {
  const geometry::Camera camera(side_camera(scanner()).camera);
  EXPECT_NEAR(camera.config().vertical_fov, 90.0 * degree, 1e-12);
  EXPECT_LE(camera.config().horizontal_fov, 2.0 * 14.5 * degree);
}

}  // namespace
}  // namespace skycap::sim
