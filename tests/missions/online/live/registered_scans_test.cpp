// Registration of scans with pose errors in scenes that constrain more or fewer directions. Where
// the surface constrains all six directions, the corrections are right.
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/points/spaced_points.h"
#include "missions/online/live/pose_check.h"
#include "sim/models/masonry/solids.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "tests/missions/room_scene.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using sim::models::box;

/// Regions of sensor positions and of targets.
struct TestPose {
  std::string name;
  geometry::Mesh mesh;
  double radius;
  Eigen::AlignedBox3d sensors, targets;
};

geometry::Mesh solids(const std::vector<Eigen::AlignedBox3d>& boxes) {
  geometry::Mesh mesh;
  for (const auto& solid : boxes) geometry::append(mesh, box(solid.min(), solid.max()));
  return mesh;
}

/// Returns three squares of 2 m.
TestPose corner() {
  return {"corner",
          solids({{Vector3d(-0.2, -0.2, -0.2), Vector3d(2, 2, 0)},
                  {Vector3d(-0.2, -0.2, 0), Vector3d(0, 2, 2)},
                  {Vector3d(0, -0.2, 0), Vector3d(2, 0, 2)}}),
          0.1,
          {Vector3d(1.8, 1.8, 1.6), Vector3d(2.8, 2.8, 2.6)},
          {Vector3d(0.5, 0.5, 0.5), Vector3d(0.8, 0.8, 0.8)}};
}

/// Returns a room 6 m wide, with a cupboard and a pillar.
TestPose room() {
  geometry::Mesh mesh = tests::room_mesh({.width = 6.0, .height = 3.0, .wall = 0.2});
  geometry::append(mesh, solids({{Vector3d(-3, 1.5, 0), Vector3d(-1.2, 3, 2)},
                                 {Vector3d(1, 1, 0), Vector3d(1.5, 1.4, 3)}}));
  return {"room",
          mesh,
          0.1,
          {Vector3d(-1, -1.5, 1), Vector3d(0.5, 0.5, 1.9)},
          {Vector3d(-2, 2, 0.6), Vector3d(-1, 2.8, 1.6)}};
}

/// Returns a building with a porch, a pilaster, eaves and ground, seen from outside.
TestPose building() {
  return {"building",
          solids({{Vector3d(-30, -30, -0.5), Vector3d(30, 30, 0)},
                  {Vector3d(-5, -4, 0), Vector3d(5, 4, 6)},
                  {Vector3d(-1.5, -5.2, 0), Vector3d(1.5, -4, 6)},
                  {Vector3d(-4, -4.6, 0), Vector3d(-3, -4, 4)},
                  {Vector3d(-5.3, -4.3, 6), Vector3d(5.3, 4.3, 6.4)}}),
          0.2,
          {Vector3d(-8, -16, 2), Vector3d(4, -11, 7)},
          {Vector3d(-2, -4, 2.5), Vector3d(2, -4, 4)}};
}

/// Returns the base of a wall.
TestPose edge() {
  return {"edge",
          solids({{Vector3d(-8, -8, -0.2), Vector3d(8, 8, 0)},
                  {Vector3d(-8, 8, 0), Vector3d(8, 8.2, 8)}}),
          0.1,
          {Vector3d(-1, 3, 1), Vector3d(1, 5, 3)},
          {Vector3d(-0.5, 8, 0.5), Vector3d(0.5, 8, 1.5)}};
}

TestPose wall() {
  return {"wall",
          box({-10, 3, -10}, {10, 3.2, 10}),
          0.1,
          {Vector3d(-1, 0, -1), Vector3d(1, 1, 1)},
          {Vector3d(-0.3, 3, -0.3), Vector3d(0.3, 3, 0.3)}};
}

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}

  Vector3d within(const Eigen::AlignedBox3d& box) {
    std::uniform_real_distribution<double> share;
    Vector3d shares;
    for (double& number : shares) number = share(random_);
    return box.min() + shares.cwiseProduct(box.sizes());
  }
  Vector3d direction() {
    std::normal_distribution<double> number;
    Vector3d direction;
    for (double& coordinate : direction) coordinate = number(random_);
    return direction.normalized();
  }

 private:
  std::mt19937_64 random_;
};

/// Results for a scan with a pose error.
struct Trial {
  PoseFinding known, unknown;  ///< with covariance and registration, and without both
  double shift, turn;          ///< remaining errors [m], [rad]
};

/// Registers a scan with a pose error of 10 cm and 1 degree.
Trial tried(const TestPose& pose, const sim::Scene& scene, double noise, std::uint64_t seed) {
  constexpr double shift = 0.1, angle = geometry::radians_per_degree;
  Numbers numbers(seed);
  sim::DepthCameraConfig config;
  config.camera = {.width = 160, .height = 120, .horizontal_fov = 1.05, .vertical_fov = 0.82};
  config.camera.max_range = 40.0;
  config.noise = {.sigma = noise, .direction = sim::NoiseDirection::along_ray, .seed = seed};
  const sim::DepthCamera camera(config);
  const auto take_scan = [&] {
    const Vector3d from = numbers.within(pose.sensors);
    return geometry::look_at(from, numbers.within(pose.targets));
  };
  const geometry::Scan first = camera.scan(scene, take_scan(), 0, 1);
  geometry::SpacedPoints spaced(0.3 * pose.radius);
  std::vector<Eigen::Vector3f> kept;
  for (const Eigen::Vector3f& point : first.points) {
    if (spaced.keep(point)) kept.push_back(point);
  }
  const geometry::Scan scan = camera.scan(scene, take_scan(), 1, 1);
  const Vector3d sensor = scan.sensor_position();
  Isometry3d error = Isometry3d::Identity();
  error.linear() = Eigen::AngleAxisd(angle, numbers.direction()).toRotationMatrix();
  error.translation() = sensor + shift * numbers.direction() - error.linear() * sensor;
  const auto found = [&](bool registers, const PoseCovariance& covariance) {
    PoseCheck check(pose.radius, registers);
    check.remember(first, kept);
    return check.find(corrected(scan, error), covariance);
  };
  Trial trial{.known = found(true, PoseCovariance::of(0.5 * shift, 0.6 * angle)),
              .unknown = found(false, {}),
              .shift = 0.0,
              .turn = 0.0};
  const Isometry3d rest = trial.known.correction.value_or(Isometry3d::Identity()) * error;
  trial.shift = (rest * sensor - sensor).norm();
  trial.turn = Eigen::AngleAxisd(rest.linear()).angle();
  return trial;
}

struct Counts {
  int all = 0;
  int missed = 0;     ///< errors not detected without information about the pose
  int corrected = 0;  ///< all directions are constrained
  int fine = 0;       ///< number of corrected scans within 1 cm and 0.1 degrees
  int far = 0;        ///< number of corrected scans off by more than 3 cm or 0.5 degrees
};

/// Tries the same number of scans for each noise level.
Counts count(const TestPose& pose) {
  const char* const more = std::getenv("REGISTERED_SCANS");
  const std::uint64_t scans = more == nullptr ? 16 : std::strtoul(more, nullptr, 10);
  const sim::Scene scene(geometry::Mesh(pose.mesh), 1);
  Counts counts;
  for (const double noise : {0.0, 0.005, 0.01, 0.02}) {
    for (std::uint64_t seed = 1; seed <= scans; ++seed) {
      const Trial trial = tried(pose, scene, noise, seed);
      ++counts.all;
      const PoseFinding& unknown = trial.unknown;
      counts.missed += unknown.is_checked && unknown.unobservable == 0 && !unknown.is_wrong ? 1 : 0;
      if (!trial.known.correction || trial.known.unobservable > 0) continue;
      const double turn_deg = trial.turn / geometry::radians_per_degree;
      ++counts.corrected;
      counts.fine += trial.shift <= 0.01 && turn_deg <= 0.1 ? 1 : 0;
      const bool is_far = trial.shift > 0.03 || turn_deg > 0.5;
      counts.far += is_far ? 1 : 0;
      if (is_far) {
        std::cout << pose.name << ", noise " << noise << ", seed " << seed << ": " << trial.shift
                  << " m, " << turn_deg << " deg left\n";
      }
    }
  }
  std::cout << pose.name << ": of " << counts.all << " scans " << counts.corrected
            << " corrected and shown whole, " << counts.fine
            << " of them to within 1 cm and 0.1 deg, " << counts.far
            << " off by more than 3 cm or 0.5 deg; " << counts.missed << " not flagged\n";
  return counts;
}

// REGISTERED_SCANS in the environment sets the number of scans for each noise level (default: 16).
TEST(RegisteredScans, AreCorrectWhenSurfaceConstrainsAllDirections) {
  const Counts corner_counts = count(corner()), in_room = count(room()),
               building_counts = count(building());
  EXPECT_EQ(corner_counts.far + in_room.far + building_counts.far, 0);
  EXPECT_GE(corner_counts.fine, corner_counts.all * 8 / 10);
  const int missed = corner_counts.missed + in_room.missed + building_counts.missed;
  EXPECT_LE(missed, 3 * corner_counts.all / 50);
}

/// Neither a wall nor its base constrains all directions.
TEST(RegisteredScans, AreNotCorrectedWhenSurfaceAllowsSliding) {
  EXPECT_EQ(count(wall()).corrected, 0);
  EXPECT_EQ(count(edge()).corrected, 0);
}

}  // namespace
}  // namespace skycap::missions::online
