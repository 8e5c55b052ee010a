#include "geometry/pose/pose.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

TEST(CameraPose, RoundTripsViewAndIsRotation) {
  for (const Vector3d& direction :
       {Vector3d(1, 2, 3), Vector3d(-1, 0, 0), Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
    const View view{{4, 5, 6}, direction.normalized()};
    const Eigen::Isometry3d pose = camera_pose(view);
    EXPECT_TRUE(pose.linear().isUnitary(1e-12));
    EXPECT_NEAR(pose.linear().determinant(), 1.0, 1e-12);
    EXPECT_TRUE(to_view(pose).position.isApprox(view.position));
    EXPECT_TRUE(to_view(pose).direction.isApprox(view.direction));
  }
}

TEST(CameraPose, KeepsImageTopUp) {
  const Eigen::Isometry3d pose = camera_pose({{0, 0, 0}, Vector3d(0, 1, 0)});
  EXPECT_TRUE((pose.linear() * Vector3d(1, 0, 0)).isApprox(Vector3d(1, 0, 0)));   // right is east
  EXPECT_TRUE((pose.linear() * Vector3d(0, 1, 0)).isApprox(Vector3d(0, 0, -1)));  // down is -z
  const Eigen::Isometry3d nadir = camera_pose({{0, 0, 0}, Vector3d(0, 0, -1)});
  EXPECT_TRUE((nadir.linear() * Vector3d(0, -1, 0)).isApprox(Vector3d(0, 1, 0)));  // top is north
}

TEST(AnyOrthogonal, IsUnitVectorOrthogonalToAxis) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(1, 1, 1)}) {
    const Vector3d across = any_orthogonal(axis.normalized());
    EXPECT_NEAR(across.norm(), 1.0, 1e-12);
    EXPECT_NEAR(across.dot(axis), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace skycap::geometry
