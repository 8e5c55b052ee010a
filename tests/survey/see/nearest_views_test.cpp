#include "survey/see/nearest_views.h"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/clouds.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;

std::vector<Vector3d> random_positions(std::size_t count, std::uint64_t seed) {
  std::vector<Vector3d> positions;
  for (const auto& p : tests::random_points(count, 3.0, seed))
    positions.push_back(p.cast<double>());
  return positions;
}

TEST(NearestViews, AreSortedByDistanceThenByIndex) {
  const std::vector<Vector3d> positions = {{3, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  EXPECT_THAT(see::nearest_views(positions, {0, 0, 0}, 3), ElementsAre(1, 2, 3));
  EXPECT_THAT(see::nearest_views(positions, {0, 0, 0}, 9), ElementsAre(1, 2, 3, 0));
}

TEST(NearestViews, MatchBruteForce) {
  const auto positions = random_positions(300, 1);
  const Vector3d query(0.3, -2, 1);
  const auto nearest = see::nearest_views(positions, query, 20);
  const double last = (positions[nearest.back()] - query).norm();
  const auto nearer = std::count_if(positions.begin(), positions.end(),
                                    [&](const Vector3d& p) { return (p - query).norm() < last; });
  EXPECT_EQ(nearer, 19);
}

// With all views in one leaf the octree has no choices, so the search is exact.
TEST(ApproximatelyNearestView, IsExactWithinALeaf) {
  const auto positions = random_positions(50, 2);
  for (const auto& query : random_positions(20, 3)) {
    EXPECT_EQ(see::approximately_nearest_view(positions, query, 100.0),
              see::nearest_views(positions, query, 1)[0]);
  }
}

// The search enters the child with the nearest centre, although the other child contains the nearer
// view. The root grows from [-0.5, 0.5] to [-0.5, 1.5] on each axis. The centre of its lower child
// is 0.
TEST(ApproximatelyNearestView, SearchesChildWithNearestCentre) {
  const std::vector<Vector3d> positions = {{0, 0, 0}, {0.55, 0, 0}};
  const Vector3d query(0.45, 0, 0);
  EXPECT_EQ(see::nearest_views(positions, query, 1)[0], 1U);
  EXPECT_EQ(see::approximately_nearest_view(positions, query, 1.0), 0U);
}

}  // namespace
}  // namespace skycap::survey
