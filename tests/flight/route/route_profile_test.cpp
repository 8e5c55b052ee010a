// Profile of a known flight over a box: heights, analytic clearances and unknown space.
#include "flight/route/route_profile.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/measured_space.h"
#include "tests/flight/scenes.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns a route from x = -30 to 30 at a height of 12 m, over a box of 10 m.
Route straight_route(const FreeSpace& space) {
  Vehicle vehicle;
  RouteOptions options;
  options.takeoff = {-30, 0, 0};
  options.takeoff_climb = 12.0;
  std::vector<CapturePoint> points(2);
  points[0].view = {{-20, 0, 12}, Vector3d::UnitX()};
  points[1].view = {{30, 0, 12}, Vector3d::UnitX()};
  points[1].view_index = 1;
  points[1].approach_path = {{-20, 0, 12}, {30, 0, 12}};
  return plan_route(points, vehicle, space, nullptr, options);
}

Obstacles box_scene() {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({-5, -5, -1}, {5, 5, 9}, 1);
  return obstacles;
}

TEST(RouteProfile, StatesAnalyticClearanceOverABox) {
  const KnownSpace space(box_scene());
  const Route route = straight_route(space);
  ASSERT_EQ(route.sorties.size(), 1U);
  ASSERT_TRUE(route.unreached.empty());
  constexpr double step = 1.0;
  const std::vector<ProfilePiece> pieces = route_profile(route, space, step);

  double end = 0.0, min_clearance = 1e9;
  std::size_t legs = 0, near_box = 0;
  for (const ProfilePiece& piece : pieces) {
    EXPECT_NEAR(piece.begin, end, 1e-9);
    EXPECT_LE(piece.end - piece.begin, step + 1e-9);
    EXPECT_NEAR((piece.to - piece.from).norm(), piece.end - piece.begin, 1e-9);
    end = piece.end;
    if (piece.part != ProfilePart::leg) {
      EXPECT_FALSE(piece.clearance.has_value());
      continue;
    }
    ++legs;
    // Distance from a piece at height 12 m and y = 0 to the box, whose top edges are at x = +-5 and
    // height 9 m.
    const double near_x = std::min(std::abs(piece.from.x()), std::abs(piece.to.x()));
    const double expected = std::hypot(std::max(0.0, near_x - 5.0), 3.0);
    const double cap = route.clearance + reported_surplus;
    EXPECT_NEAR(piece.clearance.value(), std::min(expected, cap), 1e-5) << piece.from.x();
    if (expected < cap - 0.1) {
      ++near_box;
      EXPECT_EQ(piece.closest.kind, ObstacleKind::mesh);
      EXPECT_FALSE(piece.obstacle.empty());
      EXPECT_NEAR(piece.closest.on_obstacle.z(), 9.0, 1e-9);
      EXPECT_FALSE(piece.is_near_unknown());
    }
    min_clearance = std::min(min_clearance, *piece.clearance);
  }
  EXPECT_NEAR(end, route.length, 1e-6);
  EXPECT_GE(legs, 120U);  // 60 m there and back
  EXPECT_GE(near_box, 40U);
  EXPECT_NEAR(min_clearance, 3.0, 1e-5);
  EXPECT_NEAR(min_clearance, route.min_clearance, 1e-6);
}

TEST(RouteProfile, ContainsClimbAndLandingOfEachSortie) {
  const KnownSpace space(box_scene());
  const Route route = straight_route(space);
  const std::vector<ProfilePiece> pieces = route_profile(route, space, 5.0);
  EXPECT_EQ(pieces.front().part, ProfilePart::climb);
  EXPECT_EQ(pieces.front().from, route.options.takeoff);
  EXPECT_EQ(pieces.back().part, ProfilePart::landing);
  EXPECT_EQ(pieces.back().to, route.options.takeoff);
}

TEST(RouteProfile, MarksUnknownSpace) {
  MeasuredSpaceConfig config;
  config.region = {Vector3d(-6, -6, 0), Vector3d(6, 6, 8)};
  const MeasuredSpace space(config);
  const Route route = straight_route(space);
  ASSERT_EQ(route.sorties.size(), 1U);
  std::size_t unknown = 0;
  for (const ProfilePiece& piece : route_profile(route, space, 1.0)) {
    if (piece.part != ProfilePart::leg) continue;
    EXPECT_EQ(piece.is_near_unknown(), piece.closest.kind != ObstacleKind::none);
    unknown += piece.is_near_unknown() ? 1 : 0;
    if (std::abs(piece.from.x()) < 5.0) {
      EXPECT_TRUE(piece.is_near_unknown());
    }
  }
  EXPECT_GT(unknown, 20U);
}

TEST(RouteProfile, RejectsInvalidSteps) {
  const KnownSpace space(box_scene());
  const Route route = straight_route(space);
  for (const double step : {0.0, -1.0, std::nan("")}) {
    EXPECT_THAT(testing_support::thrown_message([&] { route_profile(route, space, step); }),
                testing::HasSubstr("must be positive"));
  }
}

}  // namespace
}  // namespace skycap::flight
