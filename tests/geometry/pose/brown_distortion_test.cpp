#include "geometry/pose/brown_distortion.h"

#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector2d;

// Calculated by hand at (0.3, 0.4), where r^2 is 0.25.
TEST(BrownDistortion, FollowsItsFormula) {
  const Vector2d slope(0.3, 0.4);
  EXPECT_TRUE(distort({}, slope).isApprox(slope));
  EXPECT_TRUE(distort({.k1 = 0.1}, slope).isApprox(1.025 * slope));
  EXPECT_TRUE(distort({.k2 = 0.1}, slope).isApprox(1.00625 * slope));
  EXPECT_TRUE(distort({.k3 = 0.1}, slope).isApprox(1.0015625 * slope));
  EXPECT_TRUE(distort({.p1 = 0.01}, slope).isApprox(slope + Vector2d(0.0024, 0.0057)));
  EXPECT_TRUE(distort({.p2 = 0.01}, slope).isApprox(slope + Vector2d(0.0043, 0.0024)));
}

// Property: over the field of view of a wide-angle lens, each function inverts the other.
TEST(BrownDistortion, IsInverted) {
  const BrownDistortion intrinsics{
      .k1 = -0.11, .k2 = 0.02, .p1 = 0.001, .p2 = -0.0005, .k3 = -0.003};
  for (double x = -0.75; x <= 0.75; x += 0.25) {
    for (double y = -0.55; y <= 0.55; y += 0.11) {
      const Vector2d slope(x, y);
      EXPECT_NEAR((undistort(intrinsics, distort(intrinsics, slope)) - slope).norm(), 0.0, 1e-11)
          << x << y;
    }
  }
}

}  // namespace
}  // namespace skycap::geometry
