#include "missions/online/live/box_sight.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/pose/pose.h"

namespace skycap::missions::online {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Returns a camera with a field of view of 90 by 90 degrees.
geometry::CameraConfig square_camera(double max_range = 1e4) {
  return {.width = 100,
          .height = 100,
          .horizontal_fov = 0.5 * std::numbers::pi,
          .vertical_fov = 0.5 * std::numbers::pi,
          .max_range = max_range};
}

geometry::Scan scan_from(const Vector3d& position, const Vector3d& direction) {
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose({position, direction});
  return scan;
}

// Each of six views from the centre of a cube covers exactly one face.
TEST(BoxSight, CountsWhatWasNeverInView) {
  const AlignedBox3d cube(Vector3d::Constant(-1.0), Vector3d::Constant(1.0));
  BoxSight visibility(cube, square_camera());
  EXPECT_FALSE(visibility.unseen_share());
  int faces = 0;
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)}) {
    for (const double sign : {-1.0, 1.0}) {
      visibility.add(scan_from(Vector3d::Zero(), sign * axis));
      ++faces;
      EXPECT_NEAR(visibility.unseen_share().value(), 1.0 - faces / 6.0, 1e-9);
    }
  }
}

TEST(BoxSight, KnowsTheRangeOfTheSensor) {
  const AlignedBox3d cube(Vector3d::Constant(-1.0), Vector3d::Constant(1.0));
  BoxSight visibility(cube, square_camera(0.9));
  visibility.add(scan_from(Vector3d::Zero(), Vector3d::UnitX()));
  EXPECT_EQ(visibility.unseen_share(), 1.0);
}

TEST(BoxSight, CountsPointsOutside) {
  BoxSight visibility(AlignedBox3d(Vector3d::Zero(), Vector3d::Ones()), square_camera());
  EXPECT_EQ(visibility.outside_share(), 0.0);
  geometry::Scan scan = scan_from({0.5, -3.0, 0.5}, Vector3d::UnitY());
  scan.points = {{0.5F, 0.5F, 0.5F}, {0.5F, 2.0F, 0.5F}, {0.5F, 1.0F, 0.5F}, {-1.0F, 0.0F, 0.0F}};
  visibility.add(scan);
  EXPECT_EQ(visibility.outside_share(), 0.5);
}

TEST(BoxSight, SaysNothingWithoutABox) {
  BoxSight visibility({}, square_camera());
  visibility.add(scan_from(Vector3d::Zero(), Vector3d::UnitX()));
  EXPECT_FALSE(visibility.unseen_share());
  EXPECT_EQ(visibility.outside_share(), 0.0);
}

}  // namespace
}  // namespace skycap::missions::online
