#include "survey/photo/candidates.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;
using geometry::View;
using testing::SizeIs;

TEST(PhotosBetween, FormAFanAroundACorner) {
  // Two walls meet at the origin. Both photos face the corner from 6 m.
  const View south{{0.0, -6.0, 3.0}, {0.0, 1.0, 0.0}}, west{{-6.0, 0.0, 3.0}, {1.0, 0.0, 0.0}};
  const std::vector<View> fan = photos_between(south, west, 6.0, {});
  ASSERT_THAT(fan, SizeIs(3));
  for (const View& view : fan) {
    EXPECT_NEAR((view.position - Vector3d(0.0, 0.0, 3.0)).norm(), 6.0, 1e-9);
    EXPECT_NEAR((view.position + 6.0 * view.direction - Vector3d(0.0, 0.0, 3.0)).norm(), 0.0, 1e-9);
  }
  EXPECT_NEAR(fan[1].direction.x(), std::sqrt(0.5), 1e-9);
}

TEST(PhotosBetween, OmitPositionsThatAreNotFree) {
  const View south{{0.0, -6.0, 3.0}, {0.0, 1.0, 0.0}}, west{{-6.0, 0.0, 3.0}, {1.0, 0.0, 0.0}};
  PhotoSpace space;
  space.is_free = [](const Vector3d& position) { return position.x() > -3.0; };
  EXPECT_THAT(photos_between(south, west, 6.0, space), SizeIs(1));
  const View opposite{{0.0, 6.0, 3.0}, {0.0, -1.0, 0.0}};
  EXPECT_THAT(photos_between(south, opposite, 6.0, {}), SizeIs(2));  // The middle has no direction.
}

}  // namespace
}  // namespace skycap::survey::photo
