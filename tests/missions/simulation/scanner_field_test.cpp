#include "sim/sensors/scanner_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "flight/clearance/measured_space.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/platform.h"
#include "geometry/surfaces/mesh.h"
#include "missions/config/resolve.h"
#include "missions/config/sensor_reader.h"
#include "sim/sensors/survey_sensor.h"
#include "tests/support/not_empty.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using geometry::View;

constexpr double degree = std::numbers::pi / 180.0;

config::MissionSetup make_mission(const std::string& lidar, const std::string& more = "") {
  return config::parse_mission(
      "scene: {model: builtin:teapot, longest_side: 20}\n"
      "sensor: {lidar: " +
          lidar +
          "}\n"
          "planner: {density: 100, resolution_radius: 0.5, view_distance: 10}\n"
          "evaluation: {coverage_distance: 0.1}\n"
          "flight: {vehicle: m350_rtk, cruise_speed: 4, map_error: 0.2,\n"
          "         unknown_box: {min: [-30, -30, 0], max: [30, 30, 30]}}\n" +
          more,
      "m.yaml");
}

sim::LidarConfig make_scanner(const std::string& preset) {
  return std::get<sim::LidarConfig>(config::find_sensor(preset).sensor);
}

TEST(ScannerField, DetectsScannerKinds) {
  using sim::ScannerKind;
  EXPECT_EQ(sim::find_scanner_kind(make_scanner("ouster_os1_128")), ScannerKind::ring);
  EXPECT_EQ(sim::find_scanner_kind(make_scanner("velodyne_vlp16")), ScannerKind::ring);
  EXPECT_EQ(sim::find_scanner_kind(make_scanner("riegl_vux_1uav")), ScannerKind::line);
  EXPECT_EQ(sim::find_scanner_kind(make_scanner("riegl_minivux_1uav")), ScannerKind::line);
  EXPECT_EQ(sim::find_scanner_kind(make_scanner("livox_mid70")), ScannerKind::rosette);
  EXPECT_EQ(sim::find_scanner_kind(make_scanner("dji_zenmuse_l1")), ScannerKind::rosette);
}

// Data sheets: the Mid-70 has a circular field of view of 70.4 degrees and 100,000 pulses per
// second.
TEST(ScannerField, FitsCameraIntoRoundFieldOfRosette) {
  const auto camera = sim::forward_camera(make_scanner("livox_mid70")).camera;
  const double half_diagonal = std::atan(
      std::hypot(std::tan(0.5 * camera.horizontal_fov), std::tan(0.5 * camera.vertical_fov)));
  EXPECT_NEAR(half_diagonal, 35.2 * degree, 0.5 * degree);
  const double pixels = static_cast<double>(camera.width) * camera.height;
  EXPECT_LT(pixels, 1e5 * sim::rosette_period);
  EXPECT_GT(pixels, 0.5 * 1e5 * sim::rosette_period);  // a square inside a circle: 64%
}

// The longer the rosette is drawn, the smaller are its gaps.
TEST(ScannerField, ShrinksRosetteGapsWithTime) {
  const sim::LidarConfig lidar = make_scanner("livox_avia");
  Eigen::Matrix3d optical_from_scanner;
  optical_from_scanner << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  double last = 1.0;
  for (const double period : {0.1, 0.25, 0.5}) {
    const double gap = sim::rosette_field(lidar, period, optical_from_scanner).gap;
    EXPECT_LT(gap, last) << period;
    last = gap;
  }
  EXPECT_LT(last, 1.0 * degree);
}

TEST(ScannerField, LooksLeftAndDownForRosetteUnlessMountIsSet) {
  const config::MissionSetup usual = make_mission("livox_avia");
  const View nose{{1, 2, 30}, {0, 1, 0}};
  const View left = geometry::scanner_view(*usual.sensor().mount, nose);
  EXPECT_LT((left.direction - Vector3d(-std::sqrt(0.75), 0, -0.5)).norm(), 1e-9);
  EXPECT_LT((geometry::nose_view(*usual.sensor().mount, left).direction - nose.direction).norm(),
            1e-9);
  const config::MissionSetup ahead =
      make_mission("livox_avia", "scan: {mount: {rotation_deg: [0, 45, 0]}}\n");
  EXPECT_LT((geometry::scanner_view(*ahead.sensor().mount, nose).direction -
             Vector3d(0, std::sqrt(0.5), -std::sqrt(0.5)))
                .norm(),
            1e-9);
}

geometry::Mesh box(const Vector3d& low, const Vector3d& high) {
  geometry::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 7, 5}, {4, 6, 7}, {0, 5, 1}, {0, 4, 5},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

/// Returns a room of 40 x 40 x 20 m, observed from inside, with a column and thin poles.
geometry::Mesh room() {
  geometry::Mesh mesh = box({-20, -20, 0}, {20, 20, 20});
  geometry::append(mesh, box({4, 4, 0}, {6, 6, 20}));
  for (const Vector3d& pole : {Vector3d(-3, 8, 0), Vector3d(5, -6, 0), Vector3d(-8, -4, 0)}) {
    geometry::append(mesh, box(pole, pole + Vector3d(0.3, 0.3, 20)));
  }
  return mesh;
}

sim::PlatformMotion on_stretch(const View& from, const View& to, double duration) {
  sim::PlatformMotion platform_motion;
  platform_motion.stretch = {from, to, duration};
  return platform_motion;
}

// Safety property: surface is never classified as free space, for any flight between the first and
// the last ray of a scan.
TEST(ScannerField, ContainsNoSurfaceInFreeSpaceOfRosette) {
  const geometry::Mesh mesh = room();
  const sim::Scene scene(mesh);
  const geometry::SurfaceSamples truth = geometry::sample_surface(mesh, 20'000, 3);
  for (const char* lidar : {"livox_avia", "livox_mid70"}) {
    const config::MissionSetup mission = make_mission(lidar);
    const sim::SurveySensor sensor(mission.sensor(), 1);
    const flight::SweepRays rays = mission.flight().capture.rays.value();
    flight::MeasuredSpace space(
        {.voxel = 0.25, .depth_margin = mission.flight().map_error, .max_depth = 60.0});
    const double step = mission.flight().cruise_speed * mission.sensor().frame_period;
    std::uint64_t frame = 0;
    for (double x = -16.0; x < 16.0; x += step) {
      const double turn = 0.05 * x;
      const View from{{x, -12, 12}, {std::cos(turn), std::sin(turn), 0}};
      const View to{{x + step, -12, 12}, from.direction};
      const View middle{0.5 * (from.position + to.position), from.direction};
      space.insert(sensor.scan(scene, geometry::scanner_view(*mission.sensor().mount, middle),
                               on_stretch(from, to, mission.sensor().frame_period), frame++, 1),
                   rays);
    }
    EXPECT_GT(space.free_volume(), 1000.0) << lidar;  // of 32,000 m^3
    for (const Eigen::Vector3f& p : testing_support::not_empty(truth.points)) {
      const Vector3d position = p.cast<double>();
      ASSERT_NE(space.closest({position, position}, 0.01).kind, flight::ObstacleKind::none)
          << lidar << " at " << position.transpose();
    }
  }
}

// The scan of a single-line LiDAR in flight covers the whole leg, line by line.
TEST(ScannerField, CoversWholeLegWithSingleLineLidar) {
  const sim::Scene scene(room());
  const config::MissionSetup mission = make_mission("riegl_vux_1uav");
  sim::SurveySensorOptions exact = mission.sensor();
  exact.scanner->errors = {};
  exact.scanner->beam = {};
  const sim::SurveySensor sensor(exact, 1);
  const View from{{-11, 0, 10}, {1, 0, 0}}, to{{-9, 0, 10}, {1, 0, 0}},
      middle{{-10, 0, 10}, {1, 0, 0}};
  const View side = geometry::scanner_view(*mission.sensor().mount, middle);
  const geometry::Scan scan = sensor.scan(scene, side, on_stretch(from, to, 0.5), 7, 1);
  std::vector<double> along;
  for (const Eigen::Vector3f& point : scan.points) along.push_back(point.x());
  std::ranges::sort(along);
  const double lever_arm = mission.scan.mount_position.x();
  EXPECT_NEAR(along.front(), -11.0 + lever_arm, 0.03);
  EXPECT_NEAR(along.back(), -9.0 + lever_arm, 0.03);
  double widest = 0.0;
  for (std::size_t i = 1; i < along.size(); ++i) widest = std::max(widest, along[i] - along[i - 1]);
  EXPECT_LT(widest, 1.05 * 2.0 / 100.0);  // a hundred lines on 2 m
  EXPECT_FALSE(mission.flight().capture.rays.has_value());
}

}  // namespace
}  // namespace skycap::missions
