#include "flight/paths/path.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/flight/scenes.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

KnownSpace make_space(geometry::Mesh mesh) {
  Obstacles obstacles;
  obstacles.mesh = std::move(mesh);
  return KnownSpace(obstacles);
}

void expect_verified(const FreeSpace& space, const Path& path, double clearance) {
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    EXPECT_TRUE(verify(space, {path.points[i - 1], path.points[i]}, clearance).is_verified)
        << "piece " << i;
  }
}

/// Returns the length of the shortest path around a corner in the plane at distance `radius`,
/// counter-clockwise: tangent, arc, tangent.
double round_corner(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                    const Eigen::Vector2d& corner, double radius) {
  const Eigen::Vector2d a = from - corner, b = to - corner;
  double between = std::atan2(b.y(), b.x()) - std::atan2(a.y(), a.x());
  if (between < 0.0) between += 2.0 * std::numbers::pi;
  const double arc = between - std::acos(radius / a.norm()) - std::acos(radius / b.norm());
  return std::sqrt(a.squaredNorm() - radius * radius) +
         std::sqrt(b.squaredNorm() - radius * radius) + radius * arc;
}

TEST(Path, IsStraightLineWhenFree) {
  const KnownSpace space = make_space(scenes::box({0, 0, 0}, {10, 10, 10}));
  PathFinder finder(space, 2.0);
  const Path path = finder.find({-5, -5, 5}, {20, -5, 5});
  EXPECT_EQ(path.status, PathStatus::found);
  EXPECT_THAT(path.points, testing::ElementsAre(Vector3d(-5, -5, 5), Vector3d(20, -5, 5)));
  EXPECT_EQ(path.expansions, 0U);
}

// From one face of a tall box to the adjacent one: tangent, arc around the edge at the clearance,
// tangent. Requirement: within 2% of this length.
TEST(Path, IsWithinTwoPercentOfShortestAroundOneEdge) {
  const KnownSpace space = make_space(scenes::box({0, 0, -300}, {40, 40, 300}));
  for (const double clearance : {0.5, 2.0, 5.0}) {
    PathFinder finder(space, clearance);
    const Path path = finder.find({20, -8, 0}, {48, 20, 0});
    const double shortest = round_corner({20, -8}, {48, 20}, {40, 0}, clearance);
    ASSERT_EQ(path.status, PathStatus::found);
    EXPECT_GE(path.length, shortest - 1e-3);
    EXPECT_LE(path.length, 1.02 * shortest) << "clearance " << clearance;
    expect_verified(space, path, clearance);
  }
}

// To the opposite face, by symmetry around two edges.
TEST(Path, IsWithinTwoPercentOfShortestAroundTwoEdges) {
  const KnownSpace space = make_space(scenes::box({0, 0, -300}, {40, 40, 300}));
  const double clearance = 2.0;
  PathFinder finder(space, clearance);
  const Path path = finder.find({20, -10, 0}, {20, 50, 0});
  // Halfway, the path passes the middle of the side at the clearance, parallel to it.
  const double shortest = 2.0 * round_corner({20, -10}, {42, 20}, {40, 0}, clearance);
  ASSERT_EQ(path.status, PathStatus::found);
  EXPECT_GE(path.length, shortest - 1e-3);
  EXPECT_LE(path.length, 1.02 * shortest);
  expect_verified(space, path, clearance);
}

// A wall 1 m thick, too large to fly around, with a window 6 m wide. Clearance: 2 m. The path is in
// a plane of symmetry and bends around both edges of the left side of the window.
TEST(Path, FindsWindowInWall) {
  geometry::Mesh wall = scenes::box({-200, 0, -200}, {0, 1, 200});
  geometry::append(wall, scenes::box({6, 0, -200}, {200, 1, 200}));
  geometry::append(wall, scenes::box({0, 0, -200}, {6, 1, -3}));
  geometry::append(wall, scenes::box({0, 0, 3}, {6, 1, 200}));
  const KnownSpace space = make_space(wall);
  const double clearance = 2.0;
  PathFinder finder(space, clearance);
  const Path path = finder.find({-12, -15, 0}, {-12, 16, 0});
  ASSERT_EQ(path.status, PathStatus::found);
  expect_verified(space, path, clearance);
  const double shortest = 2.0 * round_corner({-12, -15}, {2, 0.5}, {0, 0}, clearance);
  EXPECT_GE(path.length, shortest - 1e-3);
  EXPECT_LE(path.length, 1.02 * shortest);
}

// Corridor with a right angle, 5 m wide and closed above and below. Clearance: 2 m.
TEST(Path, FollowsCorridorWithRightAngle) {
  geometry::Mesh walls = scenes::box({0, 5, 0}, {25, 30, 5});    // inner block
  geometry::append(walls, scenes::box({0, -1, 0}, {31, 0, 5}));  // outer walls
  geometry::append(walls, scenes::box({30, 0, 0}, {31, 30, 5}));
  geometry::append(walls, scenes::box({-1, -2, 5}, {32, 31, 6}));   // ceiling
  geometry::append(walls, scenes::box({-1, -2, -1}, {32, 31, 0}));  // floor
  geometry::append(walls, scenes::box({-1, -2, 0}, {0, 31, 5}));    // both ends closed
  geometry::append(walls, scenes::box({0, 30, 0}, {32, 31, 5}));
  const KnownSpace space = make_space(walls);
  PathFinder finder(space, 2.0);
  const Vector3d from(3, 2.5, 2.5), to(27.5, 27, 2.5);
  const Path path = finder.find(from, to);
  ASSERT_EQ(path.status, PathStatus::found);
  expect_verified(space, path, 2.0);
  const double shortest = round_corner({3, 2.5}, {27.5, 27}, {25, 5}, 2.0);
  EXPECT_GE(path.length, shortest - 1e-3);
  EXPECT_LE(path.length, 1.02 * shortest);
  EXPECT_EQ(finder.find(from, {27.5, 40, 2.5}).status, PathStatus::unreachable);
}

TEST(Path, IsIndependentOfEarlierQueries) {
  std::mt19937_64 random(3);
  const KnownSpace space = make_space(scenes::boxes(random, 40));
  const Eigen::AlignedBox3d around(Vector3d::Zero(), Vector3d::Constant(60));
  PathFinder used(space, 1.0);
  int found = 0;
  for (int i = 0; i < 40; ++i) {
    const Vector3d from = scenes::point_in(random, around), to = scenes::point_in(random, around);
    const Path path = used.find(from, to);
    EXPECT_EQ(PathFinder(space, 1.0).find(from, to).points, path.points);
    expect_verified(space, path, 1.0);
    found += path.status == PathStatus::found ? 1 : 0;
  }
  EXPECT_GT(found, 10);
}

TEST(Path, ReportsUnreachableGoalAndBlockedEnds) {
  geometry::Mesh cage = scenes::box({-5, -5, -5}, {5, 5, 5});
  Obstacles obstacles;
  obstacles.mesh = cage;
  obstacles.mesh_is_solid = false;
  const KnownSpace hollow(obstacles), full(make_space(cage));
  EXPECT_EQ(PathFinder(hollow, 1.0).find({0, 0, 0}, {20, 0, 0}).status, PathStatus::unreachable);
  EXPECT_EQ(PathFinder(full, 1.0).find({0, 0, 0}, {20, 0, 0}).status, PathStatus::start_not_free);
  EXPECT_EQ(PathFinder(full, 1.0).find({20, 0, 0}, {0, 0, 0}).status, PathStatus::goal_not_free);
  EXPECT_EQ(PathFinder(full, 1.0).find({20, 0, 0}, {5.5, 0, 0}).status, PathStatus::goal_not_free);
}

TEST(Path, HasNoFreeStartOutsideFence) {
  Obstacles obstacles;
  obstacles.fence = Prism{"far away", {{1000, 1000}, {1010, 1000}, {1010, 1010}}, 0, 50};
  const KnownSpace space(obstacles);
  EXPECT_EQ(PathFinder(space, 1.0).find({0, 0, 10}, {5, 0, 10}).status, PathStatus::start_not_free);
}

TEST(Path, KeepsEndsAndShortensWhenPulledTight) {
  std::mt19937_64 random(5);
  const KnownSpace space = make_space(scenes::box({0, 0, -50}, {10, 10, 50}));
  const std::vector<Vector3d> detour{
      {-10, -10, 0}, {-15, 5, 3}, {-10, 30, -2}, {5, 25, 8}, {20, 20, 0}};
  const std::vector<Vector3d> tight = pull_tight(space, 1.0, detour, 0.002);
  EXPECT_EQ(tight.front(), detour.front());
  EXPECT_EQ(tight.back(), detour.back());
  EXPECT_LT(length(tight), 0.75 * length(detour));
}

TEST(Path, RejectsInvalidOptions) {
  const KnownSpace space = make_space(scenes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_THAT(testing_support::thrown_message([&] { PathFinder(space, -1.0); }),
              testing::HasSubstr("the clearance is -1.0"));
  EXPECT_THAT(testing_support::thrown_message([&] { PathFinder(space, std::nan("")); }),
              testing::HasSubstr("the clearance is nan"));
  PathOptions options;
  options.max_expansions = 0;
  EXPECT_THAT(testing_support::thrown_message([&] { PathFinder(space, 1.0, options); }),
              testing::HasSubstr("path.max_expansions is 0"));
}

}  // namespace
}  // namespace skycap::flight
