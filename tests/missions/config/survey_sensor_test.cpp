#include "missions/config/survey_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/place/camera.h"
#include "missions/config/resolved_mission.h"
#include "missions/simulation/survey_runner.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

/// 40 lasers a degree apart, the lowest at -25 degrees, 1 degree between firings.
sim::LidarConfig scanner() {
  sim::LidarConfig lidar;
  lidar.rotation_rate = 10.0;
  lidar.firing_period = 1.0 / 3600.0;
  lidar.channels.clear();
  for (int i = 0; i < 40; ++i) lidar.channels.push_back({.elevation = (i - 25) * degree});
  return lidar;
}

/// The walls of a room of 20 m, seen from inside.
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

config::SurveySensor sensor_of(const sim::LidarConfig& lidar) {
  config::SensorConfig config;
  config.scanner = lidar;
  return config::SurveySensor(config, 1);
}

TEST(SurveySensor, AStandingScannerMeasuresAllAroundAndNamesNoPixels) {
  const sim::Scene scene(room());
  const geometry::View view = geometry::look_at({1, 2, 3}, {9, 4, 1});
  const geometry::Scan scan = sensor_of(scanner()).scan(scene, view, 0, 1);
  EXPECT_EQ(scan.points.size(), 360U * 40U);
  EXPECT_TRUE(scan.pixels.empty());
  EXPECT_LT((geometry::view_of(scan.world_from_sensor).direction - view.direction).norm(), 1e-12);
  for (const Vector3f& point : scan.points) {
    EXPECT_NEAR(point.cwiseAbs().maxCoeff(), 10.0F, 1e-4F);
  }
}

// The planner counts on what the forward camera would see: as many rays, in the same directions.
TEST(SurveySensor, TheForwardCameraSeesWhatTheScannerMeasuresBeforeIt) {
  const sim::Scene scene(room());
  const geometry::View view = geometry::look_at({1, 2, 3}, {9, 4, 1});
  const geometry::Scan scan = sensor_of(scanner()).scan(scene, view, 0, 1);
  const geometry::Camera camera(config::forward_camera(scanner()).camera);
  EXPECT_NEAR(camera.config().horizontal_fov, 90.0 * degree, 1e-12);
  EXPECT_NEAR(camera.config().vertical_fov, 40.0 * degree, 1e-12);

  const Eigen::Isometry3d camera_from_world = scan.world_from_sensor.inverse();
  int in_view = 0, in_middle = 0;
  double highest = 0.0, lowest = 0.0;
  for (const Vector3f& point : scan.points) {
    const Vector3d in_camera = camera_from_world * point.cast<double>();
    const auto pixel = camera.project(in_camera);
    if (!pixel) continue;
    ++in_view;
    highest = std::max(highest, std::atan2(-in_camera.y(), in_camera.z()));
    lowest = std::min(lowest, std::atan2(-in_camera.y(), in_camera.z()));
    const Eigen::Vector2d off = (*pixel - camera.principal_point_px()).cwiseAbs();
    in_middle += off.x() < 0.125 * camera.width() && off.y() < 0.25 * camera.height() ? 1 : 0;
  }
  // Lasers from -19.5 to 19.5 degrees about the axis, on cones where the image has lines.
  EXPECT_NEAR(highest, 20.0 * degree, 0.6 * degree);
  EXPECT_NEAR(lowest, -20.0 * degree, 0.6 * degree);
  const double pixels = static_cast<double>(camera.width()) * camera.height();
  // An eighth of the image, where rays and pixels are equally dense but for the rounding of a
  // quarter of some 40 rows and columns.
  EXPECT_NEAR(in_middle, pixels / 8.0, 0.12 * pixels / 8.0);
  // At azimuth a the image's upper edge is seen at the elevation atan(tan(20) cos(a)); rays are a
  // degree apart either way. The lasers' cones, tilted by 5.5 degrees, are off that by some
  // percent.
  double rays = 0.0;
  for (int a = -45; a < 45; ++a) {
    rays += 2.0 / degree * std::atan(std::tan(20.0 * degree) * std::cos((a + 0.5) * degree));
  }
  EXPECT_NEAR(in_view, rays, 0.03 * rays);
}

TEST(SurveySensor, SweepsDependOnSeedAndFrameButNotOnThreads) {
  const sim::Scene scene(room());
  const geometry::View view{{0, 0, 0}, {1, 0, 0}};
  sim::LidarConfig lidar = scanner();
  lidar.errors.sigma = 0.02;
  const config::SurveySensor sensor = sensor_of(lidar);
  const geometry::Scan scan = sensor.scan(scene, view, 3, 1);
  EXPECT_EQ(scan.points, sensor.scan(scene, view, 3, 3, scan).points);
  EXPECT_NE(scan.points, sensor.scan(scene, view, 4, 1).points);
  EXPECT_EQ(scan.points.size(), sensor.scan(scene, view, 4, 1).points.size());
}

/// Its axis along the flight, and across it to the left.
config::ScannerMount level_mount(double azimuth) {
  return config::scanner_mount(
      scanner(), Eigen::Isometry3d(Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(90.0 * degree, Vector3d::UnitY())));
}

TEST(MountedScanner, LooksToTheLeftOfItsAxisWhereverTheNosePoints) {
  const geometry::View north{{1, 2, 3}, {0, 1, 0}};
  const geometry::View west = config::scanner_view(level_mount(0.0), north);
  EXPECT_LT((west.direction - Vector3d(-1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(west.position, north.position);
  const geometry::View south = config::scanner_view(level_mount(90.0 * degree), north);
  EXPECT_LT((south.direction - Vector3d(0, -1, 0)).norm(), 1e-12);
  for (const double azimuth : {0.0, 0.7, -2.0}) {
    const config::ScannerMount mount = level_mount(azimuth);
    EXPECT_LT(
        (config::nose_view(mount, config::scanner_view(mount, north)).direction - north.direction)
            .norm(),
        1e-12);
    // How steeply a view looks does not turn the nose.
    geometry::View steep = config::scanner_view(mount, north);
    steep.direction = (steep.direction - 5.0 * Vector3d::UnitZ()).normalized();
    EXPECT_LT((config::nose_view(mount, steep).direction - north.direction).norm(), 1e-12);
  }
}

// A scan in flight stands for the turns around it: all rays lie in the ring about the axis.
TEST(MountedScanner, SweepsARingAboutItsAxisOnceForEachTurnOfThePeriod) {
  const sim::Scene scene(room());
  config::SensorConfig config;
  config.scanner = scanner();
  config.mount = level_mount(0.0);
  config.capture = config::Capture::moving;
  config.frame_period = 0.5;  // five turns
  const config::SurveySensor sensor(config, 1);
  const geometry::View view = config::scanner_view(*config.mount, {{1, 2, 3}, {0.6, 0.8, 0}});
  const geometry::Scan scan = sensor.scan(scene, view, 0, 1);
  EXPECT_EQ(scan.points.size(), 5U * 360U * 40U);
  const Vector3d axis(0.6, 0.8, 0.0);
  double ahead = -1.0, behind = 1.0;
  for (const Vector3f& point : scan.points) {
    const double sine = (point.cast<double>() - view.position).normalized().dot(axis);
    ahead = std::max(ahead, sine), behind = std::min(behind, sine);
  }
  // Lasers from -25 to 14 degrees; turns begin up to 13 cm off, 7 m or more from the walls.
  EXPECT_NEAR(std::asin(ahead), 14.0 * degree, 1.1 * degree);
  EXPECT_NEAR(std::asin(behind), -25.0 * degree, 1.1 * degree);
}

// The planner's camera promises nothing that the ring has not.
TEST(MountedScanner, TheSideCameraSeesNoDirectionThatTheRingLeavesOut) {
  const geometry::Camera camera(config::side_camera(scanner()).camera);
  EXPECT_NEAR(camera.config().vertical_fov, 90.0 * degree, 1e-12);
  EXPECT_LE(camera.config().horizontal_fov, 2.0 * 14.5 * degree);
}

TEST(RunSurvey, EveryPlannerTakesSweeps) {
  const tests::TestFolder folder;
  const std::string lidar = folder.write(
      "lidar.yaml",
      "name: test\nkind: spinning\ncolumns_per_turn: 720\nrotation_rate_hz: 10\n"
      "channels: {count: 64, lowest_deg: -20, highest_deg: 20}\nrange: {min: 0.1, max: 20}\n"
      "errors: {sigma: 0.01}\n");
  for (const char* name : {"see++", "see", "skycap", "rsv"}) {
    const config::Mission mission = config::parse_mission(
        "scene: {model: builtin:teapot, longest_side: 1}\nsensor: {lidar: " + lidar +
            "}\nplanner: {name: " + name +
            ", density: 20000, resolution_radius: 0.08, spacing: 0.02, view_distance: 1.5}\n"
            "limits: {max_views: 30}\n"
            "evaluation: {registration_distance: 0.03, samples: 2000, ceiling_views: 0}\n",
        "m.yaml");
    const session::SurveyRecord record =
        simulation::run_survey(mission, evaluation::SurveyScene(mission, ""), 1, 1);
    EXPECT_GT(record.views.size(), 2U) << name;
    EXPECT_GT(record.coverage(), 0.4) << name;  // twice what one view shows of the teapot
  }
}

TEST(SensorLidar, IsRefusedWithOneSentenceWhereItDoesNotFit) {
  const auto message_of = [](const std::string& sensor, const std::string& more) -> std::string {
    try {
      config::parse_mission("scene: {model: builtin:teapot}\nsensor: " + sensor +
                                "\nplanner: {density: 100, resolution_radius: 0.2}\n"
                                "evaluation: {registration_distance: 0.2}\n" +
                                more,
                            "m.yaml");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_config);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message_of("{lidar: velodyne_vlp16}", ""), "accepted");
  EXPECT_EQ(message_of("{lidar: livox_avia}", ""), "accepted");
  EXPECT_THAT(
      message_of("{lidar: riegl_vux_1uav}", ""),
      HasSubstr("m.yaml:2: key sensor.lidar: this scanner measures a line, which is no field "
                "unless it is flown: give flight.vehicle"));
  EXPECT_THAT(message_of("{lidar: see_d435}", ""), HasSubstr("is a camera"));
  EXPECT_THAT(message_of("{lidar: os1}", ""), HasSubstr("known are"));
  EXPECT_THAT(message_of("{lidar: velodyne_vlp16, width: 100}", ""),
              HasSubstr("key sensor.width: does not go with sensor.lidar"));
  const std::string flown =
      "flight: {vehicle: m350_rtk, unknown_box: {min: [-1, -1, 0], max: [1, 1, 1]}}\n";
  EXPECT_EQ(message_of("{lidar: velodyne_vlp16}", flown), "accepted");
  EXPECT_THAT(message_of("{lidar: velodyne_vlp16, width: 100}", flown),
              HasSubstr("key sensor.width: does not go with sensor.lidar"));
  EXPECT_THAT(
      message_of("{lidar: velodyne_vlp16}", flown + "scan: {mount: {rotation_deg: [0, 0, 30]}}\n"),
      HasSubstr("key scan.mount.rotation_deg: does not lay the scanner's axis level"));
  EXPECT_EQ(message_of("{lidar: livox_avia}", flown), "accepted");
  EXPECT_THAT(
      message_of("{lidar: livox_avia}", flown + "scan: {mount: {rotation_deg: [0, 90, 0]}}\n"),
      HasSubstr("key scan.mount.rotation_deg: has the scanner look up or down by more than 75"));
  EXPECT_EQ(message_of("{lidar: riegl_vux_1uav}", flown), "accepted");
  EXPECT_THAT(message_of("{lidar: riegl_vux_1uav, capture: stops}", flown),
              HasSubstr("key sensor.capture: is stops, at which a scanner that measures a line"));
}

}  // namespace
}  // namespace skycap::missions
