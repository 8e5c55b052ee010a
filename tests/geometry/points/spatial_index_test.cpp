#include "geometry/points/spatial_index.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/clouds.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3f;
using tests::random_points;

std::vector<Neighbour> brute_force_within(const std::vector<Vector3f>& points,
                                          const Vector3f& query, double radius) {
  std::vector<Neighbour> found;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const float distance = squared_distance(query, points[i]);
    if (distance <= static_cast<float>(radius * radius)) found.push_back({distance, i});
  }
  return found;
}

std::vector<std::uint32_t> collect_indices(const std::vector<Neighbour>& neighbours) {
  std::vector<std::uint32_t> indices;
  for (const Neighbour& neighbour : neighbours) indices.push_back(neighbour.index);
  return indices;
}

/// Compares each query with brute force while the cloud grows through several sizes of the forest.
class SpatialIndexReference : public testing::TestWithParam<double> {};

TEST_P(SpatialIndexReference, MatchesBruteForceAsIndexGrows) {
  const double cell = GetParam();
  SpatialIndex index(cell);
  const auto points = random_points(20'000, 1.0, 1);
  const auto queries = random_points(8, 1.5, 2);
  std::vector<Vector3f> inserted;
  for (const std::size_t size : {1U, 10U, 300U, 3000U, 20'000U}) {
    for (std::size_t i = inserted.size(); i < size; ++i) {
      EXPECT_EQ(index.insert(points[i]), i);
      inserted.push_back(points[i]);
    }
    for (const Vector3f& query : queries) {
      for (const double radius : {0.03, 0.1, 0.5, 2.0}) {
        const auto expected = brute_force_within(inserted, query, radius);
        EXPECT_EQ(index.within(query, radius), collect_indices(expected));
        EXPECT_EQ(index.count_within(query, radius), expected.size());
        EXPECT_EQ(index.any_within(query, radius), !expected.empty());
      }
      auto by_distance = brute_force_within(inserted, query, 10.0);
      std::sort(by_distance.begin(), by_distance.end());
      for (const std::size_t count : {1U, 5U, 40U}) {
        const std::size_t expected_count = std::min<std::size_t>(count, inserted.size());
        const std::vector<Neighbour> expected(
            by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(expected_count));
        EXPECT_EQ(index.nearest(query, count), expected);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CellSizes, SpatialIndexReference, testing::Values(0.02, 0.1, 0.7));

TEST(SpatialIndex, IsEmptyInitially) {
  const SpatialIndex index(0.1);
  EXPECT_FALSE(index.any_within({0, 0, 0}, 0.1));
  EXPECT_TRUE(index.within({0, 0, 0}, 100.0).empty());
  EXPECT_TRUE(index.nearest({0, 0, 0}, 3).empty());
}

// The ball is closed: a point at exactly the radius is inside. 0.25 and its square are exact.
TEST(SpatialIndex, IncludesPointAtExactRadius) {
  SpatialIndex index(0.25);
  index.insert({1.0F, 0.0F, 0.0F});
  EXPECT_TRUE(index.any_within({1.25F, 0.0F, 0.0F}, 0.25));
  EXPECT_EQ(index.count_within({0.75F, 0.0F, 0.0F}, 0.25), 1U);
}

// Points on cell boundaries, on both sides of zero, where rounding errors would show.
TEST(SpatialIndex, FindsNeighboursAcrossCellBoundaries) {
  SpatialIndex index(0.1);
  std::vector<Vector3f> points;
  for (float x = -3; x <= 3; ++x) {
    for (float y = -3; y <= 3; ++y) points.emplace_back(0.1F * x, 0.1F * y, 0.1F * (x - y));
  }
  for (const Vector3f& p : points) index.insert(p);
  for (const Vector3f& p : points) {
    EXPECT_EQ(index.count_within(p, 0.1), brute_force_within(points, p, 0.1).size());
  }
}

TEST(SpatialIndex, FindsPointsFarFromOrigin) {
  SpatialIndex index(0.01);
  const Vector3f far_away(3e7F, -3e7F, 12.0F);
  index.insert(far_away);
  EXPECT_TRUE(index.any_within(far_away, 0.01));
  EXPECT_FALSE(index.any_within({0, 0, 0}, 0.01));
}

TEST(PointGrid, DetectsPointsNearBatch) {
  PointGrid grid(0.1);
  const Vector3f old_point(0.05F, 0.05F, 0.05F), far_point(0.95F, 0.05F, 0.05F);
  grid.begin_batch();
  grid.insert(old_point);
  grid.insert(far_point);
  grid.begin_batch();
  EXPECT_FALSE(grid.is_near_batch(old_point));
  const Vector3f new_point(0.15F, 0.05F, 0.05F);
  grid.insert(new_point);
  EXPECT_TRUE(grid.is_near_batch(old_point));
  EXPECT_FALSE(grid.is_near_batch(far_point));
  EXPECT_TRUE(grid.is_near_batch(new_point));
}

// Property: no point is within a cell width of the interval that is reported as empty.
TEST(PointGrid, ReturnsEmptyLengthWithoutNearbyPoints) {
  PointGrid grid(0.05);
  const auto points = random_points(60, 1.0, 3);
  for (const Vector3f& p : points) grid.insert(p);
  int long_ones = 0;
  const auto origins = random_points(300, 3.0, 4);
  const auto targets = random_points(300, 1.0, 5);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const Vector3f direction = (targets[i] - origins[i]).normalized();
    const auto length = static_cast<float>(grid.empty_length(origins[i], direction));
    if (length > 0.1F) ++long_ones;
    for (const Vector3f& p : points) {
      if (length == 0.0F) continue;
      const float along = std::clamp((p - origins[i]).dot(direction), 0.0F, length);
      EXPECT_GT((origins[i] + along * direction - p).norm(), 0.05F * 0.999F);
    }
  }
  EXPECT_GT(long_ones, 100);  // long intervals occur
}

}  // namespace
}  // namespace skycap::geometry
