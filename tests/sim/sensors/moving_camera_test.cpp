#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "sim/sensors/depth_camera.h"
#include "tests/sim/shapes.h"

namespace skycap::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using geometry::Scan;

constexpr double degree = std::numbers::pi / 180.0;
constexpr int width = 101, height = 67;

DepthCamera exact_camera() {
  return DepthCamera({.camera = {.width = width,
                                 .height = height,
                                 .horizontal_fov = 60 * degree,
                                 .vertical_fov = 40 * degree,
                                 .max_range = 100.0},
                      .noise = {},
                      .stereo = {}});
}

/// At the origin, looking along x. Image right is -y, and down is -z.
const Isometry3d pose = geometry::camera_pose({Vector3d::Zero(), Vector3d::UnitX()});

Scene wall_at(double x) { return Scene(square({x, 0, 0}, -Vector3d::UnitX(), 200.0), 1); }

TEST(MovingCamera, MatchesStationaryCameraWithoutMotion) {
  const Scene scene(sphere({5, 0.3, -0.2}, 1.5, 3), 1);
  const DepthCamera camera = exact_camera();
  const Scan standing = camera.scan(scene, pose, 0, 1);
  const Scan moving = camera.scan(
      scene, pose, {.world_from_camera = pose, .exposure = 0.1, .readout = 0.1, .instants = 1}, 0);
  EXPECT_EQ(moving.pixels, standing.pixels);
  ASSERT_EQ(moving.points.size(), standing.points.size());
  for (std::size_t i = 0; i < standing.points.size(); ++i) {
    EXPECT_LT((moving.points[i] - standing.points[i]).norm(), 1e-5F);
  }
}

TEST(MovingCamera, KeepsPointsWhenMovingAlongPlane) {
  const Scene scene(square({10, 0, 0}, Vector3d(-1.0, 0.3, 0.2).normalized(), 200.0), 1);
  const DepthCamera camera = exact_camera();
  const Scan standing = camera.scan(scene, pose, 0, 1);
  const Scan moving = camera.scan(
      scene, pose,
      {.world_from_camera = pose, .velocity = {0.0, 4.0, 1.0}, .exposure = 0.05, .instants = 5}, 0);
  ASSERT_EQ(moving.points.size(), standing.points.size());
  for (std::size_t i = 0; i < standing.points.size(); ++i) {
    EXPECT_LT((moving.points[i] - standing.points[i]).norm(), 1e-4F) << i;
  }
}

// In flight towards a wall, the first row is read farther away than the last one.
TEST(MovingCamera, ReadsEachRowAtItsPoseWithRollingShutter) {
  const Scene scene = wall_at(10.0);
  constexpr double speed = 5.0, readout = 0.02;
  const Scan scan = exact_camera().scan(
      scene, pose, {.world_from_camera = pose, .velocity = {speed, 0.0, 0.0}, .readout = readout},
      0);
  ASSERT_EQ(scan.points.size(), std::size_t{width} * height);
  for (std::size_t i = 0; i < scan.points.size(); i += 37) {
    const auto row = scan.pixels[i] / width;
    const double travelled = speed * readout * ((row + 0.5) / height - 0.5);
    EXPECT_NEAR(scan.points[i].x(), 10.0 - travelled, 1e-5) << row;
  }
}

// During a rotation to the left, what later rows see is shifted increasingly to the right.
TEST(MovingCamera, SkewsImageWithRollingShutterWhenTurning) {
  const Scene scene(sphere({10, 0, 0}, 0.4, 4), 1);
  constexpr double rate = 2.0, readout = 0.05;
  const DepthCamera camera = exact_camera();
  const auto columns = [&](const Scan& scan, int row) {
    double sum = 0.0, count = 0.0;
    for (const std::uint32_t pixel : scan.pixels) {
      if (static_cast<int>(pixel / width) != row) continue;
      sum += pixel % width;
      count += 1.0;
    }
    return sum / count;
  };
  const Scan scan = camera.scan(
      scene, pose, {.world_from_camera = pose, .turn_rate = {0.0, 0.0, rate}, .readout = readout},
      0);
  const double focal = camera.camera().focal_length_px().x();
  for (const int row : {height / 2 - 2, height / 2 + 2}) {
    const double angle = rate * readout * ((row + 0.5) / height - 0.5);
    EXPECT_NEAR(columns(scan, row), 0.5 * (width - 1) + focal * std::tan(angle), 0.5) << row;
  }
}

TEST(MovingCamera, DisplacesAllPointsByPoseError) {
  const Scene scene = wall_at(10.0);
  Isometry3d nearer = pose;
  nearer.translation().x() += 0.25;
  const Scan scan = exact_camera().scan(scene, pose, {.world_from_camera = nearer}, 0);
  ASSERT_EQ(scan.points.size(), std::size_t{width} * height);
  for (const auto& point : scan.points) EXPECT_NEAR(point.x(), 9.75, 1e-5);
  EXPECT_TRUE(scan.world_from_sensor.isApprox(pose));
}

// A pole in front of a wall: pixels that cross its edges during the exposure see both surfaces and
// give no return.
TEST(MovingCamera, GivesNoReturnForPixelsOnTwoSurfaces) {
  geometry::Mesh mesh = square({20, 0, 0}, -Vector3d::UnitX(), 200.0);
  const geometry::Mesh pole{{{10, -1, -50}, {10, 1, -50}, {10, 1, 50}, {10, -1, 50}},
                            {{4, 5, 6}, {4, 6, 7}}};
  mesh.vertices.insert(mesh.vertices.end(), pole.vertices.begin(), pole.vertices.end());
  mesh.triangles.insert(mesh.triangles.end(), pole.triangles.begin(), pole.triangles.end());
  const Scene scene(mesh, 1);
  const DepthCamera camera = exact_camera();
  const double focal = camera.camera().focal_length_px().x();
  // Motion of the pole's edges [px].
  constexpr double blur_px = 6.0, exposure = 0.1;
  const double speed = blur_px / focal * 10.0 / exposure;
  const Scan scan = camera.scan(scene, pose,
                                {.world_from_camera = pose,
                                 .velocity = {0.0, speed, 0.0},
                                 .exposure = exposure,
                                 .instants = 25},
                                0);
  const double lost = static_cast<double>(width) - static_cast<double>(scan.points.size()) / height;
  EXPECT_NEAR(lost, 2.0 * blur_px, 2.0);
  for (const auto& point : scan.points) {
    EXPECT_TRUE(std::abs(point.x() - 10.0F) < 1e-3F || std::abs(point.x() - 20.0F) < 1e-3F);
  }
}

TEST(MovingCamera, GivesNoReturnForPixelsThatMainlySeeSky) {
  const Scene scene(square({10, 0, 0}, -Vector3d::UnitX(), 4.0), 1);
  const DepthCamera camera = exact_camera();
  const FrameMotion motion{
      .world_from_camera = pose, .velocity = {0.0, 10.0, 0.0}, .exposure = 0.1, .instants = 21};
  const auto standing = static_cast<double>(camera.scan(scene, pose, 0, 1).points.size());
  const auto moving = static_cast<double>(camera.scan(scene, pose, motion, 0).points.size());
  EXPECT_NEAR(moving, standing, 0.05 * standing);  // the loss at one edge is the gain at the other
}

TEST(MovingCamera, DoesNotDependOnThreadCount) {
  const Scene scene(sphere({5, 0.3, -0.2}, 1.5, 3), 1);
  const DepthCamera camera = exact_camera();
  const FrameMotion motion{.world_from_camera = pose,
                           .velocity = {1.0, 2.0, -0.5},
                           .turn_rate = {0.1, 0.2, 0.3},
                           .exposure = 0.02,
                           .readout = 0.03,
                           .instants = 4};
  const Scan one = camera.scan(scene, pose, motion, 3, 1),
             two = camera.scan(scene, pose, motion, 3, 2);
  EXPECT_EQ(one.pixels, two.pixels);
  EXPECT_EQ(one.points, two.points);
}

}  // namespace
}  // namespace skycap::sim
