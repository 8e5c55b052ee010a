// Measurements of glass and mirrors.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/pose/pose.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"
#include "tests/sim/shapes.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

/// A square of this surface type in front of a matt one.
class SurfaceBefore {
 public:
  SurfaceBefore(Surface surface, const geometry::Mesh& front, const geometry::Mesh& back)
      : mesh_(front) {
    surfaces_.assign(front.triangles.size(), surface);
    geometry::append(mesh_, back);
    surfaces_.resize(mesh_.triangles.size(), Surface::matt);
  }

  Scene scene() const { return Scene(std::array{ScenePart{mesh_, {}, {}, surfaces_}}, 1); }

 private:
  geometry::Mesh mesh_;
  std::vector<Surface> surfaces_;
};

geometry::Scan capture(const Scene& scene, double max_range = 100.0) {
  const DepthCamera camera({.camera = {.width = 101,
                                       .height = 67,
                                       .horizontal_fov = 0.5,
                                       .vertical_fov = 0.3,
                                       .max_range = max_range},
                            .noise = {},
                            .stereo = {}});
  return camera.scan(scene, {Vector3d::Zero(), Vector3d::UnitX()}, 0, 1);
}

TEST(Glass, GivesNoReturnAndOccludesSurfacesBehind) {
  const geometry::Mesh wall = square({20, 0, 0}, {-1, 0, 0}, 100.0);
  const SurfaceBefore before(Surface::glass, square({10, 0, 0}, {-1, 0, 0}, 2.0), wall);
  const geometry::Scan scan = capture(before.scene());
  EXPECT_GT(scan.points.size(), 1000U);
  EXPECT_LT(scan.points.size(), 101U * 67U);
  for (const auto& point : scan.points) {
    EXPECT_NEAR(point.x(), 20.0F, 1e-4F);
    // The pane, 2 m wide at 10 m, hides 4 m of the wall at 20 m.
    EXPECT_GE(point.tail<2>().cwiseAbs().maxCoeff(), 2.0F - 1e-3F);
  }
}

TEST(Glass, GivesNoReturnToLidar) {
  const auto pane = square({10, 0, 0}, {-1, 0, 0}, 400.0);
  const auto wall = square({-10, 0, 0}, {1, 0, 0}, 400.0);
  LidarConfig config;
  config.firing_period = 1e-4;
  config.rotation_rate = 20.0;
  config.max_range = 100.0;
  config.channels = {{.elevation = 0.0, .delay = 0.0}};
  const Trajectory still({{0.0, Vector3d::Zero(), Eigen::Quaterniond::Identity()},
                          {1.0, Vector3d::Zero(), Eigen::Quaterniond::Identity()}});
  const Scene scene = SurfaceBefore(Surface::glass, pane, wall).scene();
  const LidarReturns returns = Lidar(config).measure(scene, {still, still}, {0, 500});
  EXPECT_GT(returns.size(), 100U);
  for (const auto& point : returns.points) {
    EXPECT_NEAR(returns.origin.x() + point.x(), -10.0, 1e-4);
  }
}

TEST(Mirror, ShowsMirroredWallStraightAhead) {
  // A mirror at 45 degrees 10 m ahead and a wall 7 m to its left: the image of the wall is 17 m
  // ahead.
  const geometry::Mesh glass = square({10, 0, 0}, Vector3d(-1, 1, 0).normalized(), 40.0);
  const geometry::Mesh wall = square({10, 7, 0}, {0, -1, 0}, 60.0);
  const SurfaceBefore before(Surface::mirror, glass, wall);
  const geometry::Scan scan = capture(before.scene());
  EXPECT_EQ(scan.points.size(), 101U * 67U);
  for (const auto& point : scan.points) EXPECT_NEAR(point.x(), 17.0F, 1e-3F);
  EXPECT_TRUE(capture(before.scene(), 16.9).points.empty());  // the total path length is limited
}

TEST(Mirror, GivesNoReturnBetweenFacingMirrors) {
  const geometry::Mesh ahead = square({10, 0, 0}, {-1, 0, 0}, 1000.0);
  const geometry::Mesh behind = square({-1, 0, 0}, {1, 0, 0}, 1000.0);
  geometry::Mesh both = ahead;
  geometry::append(both, behind);
  const std::vector<Surface> surfaces(both.triangles.size(), Surface::mirror);
  const Scene scene(std::array{ScenePart{both, {}, {}, surfaces}}, 1);
  EXPECT_TRUE(capture(scene, 1e4).points.empty());
}

TEST(Mirror, AppliesIncidenceLimitToMirroredSurface) {
  // The incidence angle on the wall is 0, although that on the mirror is 45 degrees.
  const geometry::Mesh glass = square({10, 0, 0}, Vector3d(-1, 1, 0).normalized(), 40.0);
  const geometry::Mesh wall = square({10, 7, 0}, {0, -1, 0}, 60.0);
  const Scene scene = SurfaceBefore(Surface::mirror, glass, wall).scene();
  const DepthCamera camera({.camera = {.width = 101,
                                       .height = 67,
                                       .horizontal_fov = 0.5,
                                       .vertical_fov = 0.3,
                                       .max_range = 100.0},
                            .noise = {},
                            .stereo = {},
                            .max_incidence = 0.4});
  const geometry::View view{Vector3d::Zero(), Vector3d::UnitX()};
  EXPECT_EQ(camera.scan(scene, view, 0, 1).points.size(), 101U * 67U);
}

}  // namespace
}  // namespace skycap::sim
