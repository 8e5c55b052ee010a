#include "flight/paths/sampling_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh.h"
#include "tests/flight/scenes.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

// Compares two planners with independent search methods. Both paths are verified. Their lengths
// agree to 5%, the accuracy of sampling with this effort.
void expect_agreement(const Obstacles& obstacles, const Vector3d& from, const Vector3d& to,
                      double clearance, const SamplingOptions& options) {
  const KnownSpace space(obstacles);
  const Path path = find_path_by_sampling(space, from, to, clearance, options);
  const Path grid = PathFinder(space, clearance).find(from, to);
  ASSERT_EQ(path.status, PathStatus::found);
  ASSERT_EQ(grid.status, PathStatus::found);
  EXPECT_LE(grid.length, 1.01 * path.length);
  EXPECT_LE(path.length, 1.05 * grid.length);
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    EXPECT_TRUE(verify(space, {path.points[i - 1], path.points[i]}, clearance).is_verified);
  }
}

Obstacles building() {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({0, 0, -30}, {20, 20, 30});
  return obstacles;
}

TEST(SamplingPath, MatchesGridPathWithBitStar) {
  expect_agreement(building(), {10, -6, 0}, {26, 14, 0}, 2.0, {});
}

TEST(SamplingPath, MatchesGridPathWithAitStar) {
  expect_agreement(building(), {10, -6, 0}, {26, 14, 0}, 2.0,
                   {.planner = SamplingPlanner::ait_star, .max_checks = 1500});
}

// From a position next to the window to one on the other side of the wall. The wall blocks the
// straight line, so each seed must find the window.
TEST(SamplingPath, FindsWindowInWallWithEverySeed) {
  const KnownSpace space(scenes::wall_with_window());
  const Vector3d from(-8, -6, 20), to(-8, 7, 20);
  const Path grid = PathFinder(space, 2.0).find(from, to);
  ASSERT_EQ(grid.status, PathStatus::found);
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Path path =
        find_path_by_sampling(space, from, to, 2.0, {.max_checks = 2000, .seed = seed});
    ASSERT_EQ(path.status, PathStatus::found) << "seed " << seed;
    EXPECT_LE(path.length, 1.05 * grid.length) << "seed " << seed;
    EXPECT_LE(grid.length, 1.01 * path.length) << "seed " << seed;
  }
}

TEST(SamplingPath, IsIndependentOfEarlierQueries) {
  const KnownSpace space(building());
  const SamplingOptions brief{.max_checks = 500};
  const auto find = [&] {
    return find_path_by_sampling(space, {10, -6, 0}, {26, 14, 0}, 2.0, brief).points;
  };
  const std::vector<Vector3d> first = find();
  find_path_by_sampling(space, {-9, 3, 5}, {30, 14, 2}, 2.0, brief);
  EXPECT_EQ(find(), first);
  EXPECT_THAT(testing_support::thrown_message([&] {
                find_path_by_sampling(space, {-9, 3, 5}, {30, 14, 2}, 2.0, {.seed = 0});
              }),
              testing::HasSubstr("the seed of a sampling search is 0"));
}

TEST(SamplingPath, ReportsUnreachableGoalAndBlockedEnds) {
  Obstacles cage;
  cage.mesh = scenes::box({-5, -5, -5}, {5, 5, 5});
  cage.mesh_is_solid = false;
  const KnownSpace space(cage);
  const SamplingOptions brief{.max_checks = 500, .max_checks_for_first_path = 2000};
  EXPECT_EQ(find_path_by_sampling(space, {0, 0, 0}, {20, 0, 0}, 1.0, brief).status,
            PathStatus::unreachable);
  EXPECT_EQ(find_path_by_sampling(space, {4.5, 0, 0}, {20, 0, 0}, 1.0, brief).status,
            PathStatus::start_not_free);
  EXPECT_EQ(find_path_by_sampling(space, {20, 0, 0}, {4.5, 0, 0}, 1.0, brief).status,
            PathStatus::goal_not_free);
}

}  // namespace
}  // namespace skycap::flight
