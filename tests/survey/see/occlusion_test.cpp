#include "survey/see/occlusion.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/clouds.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

geometry::PointGrid make_grid(const std::vector<Vector3f>& points, double radius) {
  geometry::PointGrid grid(radius);
  for (const Vector3f& p : points) grid.insert(p);
  return grid;
}

/// Returns points at z = `height`, 5 cm apart, on a square of 4 m.
std::vector<Vector3f> wall(float height) {
  std::vector<Vector3f> points;
  for (float x = -2; x <= 2; x += 0.05F) {
    for (float y = -2; y <= 2; y += 0.05F) points.emplace_back(x, y, height);
  }
  return points;
}

// Definition: one of the samples zeta, zeta + r, ... up to psi has a point within r.
TEST(OcclusionTest, MatchesDefinition) {
  const auto points = tests::random_points(400, 1.0, 11);
  const double radius = 0.05;
  const geometry::PointGrid grid = make_grid(points, radius);
  const auto frontiers = tests::random_points(40, 1.0, 12),
             sensors = tests::random_points(40, 4.0, 13);
  int occluded = 0;
  for (const double search_distance : {0.5, 3.0, 50.0}) {
    const see::OcclusionTest test(grid, {.radius = radius, .search_distance = search_distance});
    for (std::size_t i = 0; i < frontiers.size(); ++i) {
      const Vector3d frontier = frontiers[i].cast<double>(), sensor = sensors[i].cast<double>();
      const double length = (sensor - frontier).norm(), offset = 0.15;
      bool expected = false;
      for (int step = 0; offset + step * radius <= std::min(search_distance, length); ++step) {
        const Vector3d centre = frontier + (offset + step * radius) * (sensor - frontier) / length;
        for (const Vector3f& p : points) {
          expected |= geometry::squared_distance(p, centre.cast<float>()) <=
                      static_cast<float>(radius * radius);
        }
      }
      EXPECT_EQ(test.is_occluded(frontier, offset, sensor), expected) << i;
      occluded += expected ? 1 : 0;
    }
  }
  EXPECT_GT(occluded, 20);
  EXPECT_LT(occluded, 100);
}

TEST(OcclusionTest, IgnoresPointsBehindSensor) {
  const geometry::PointGrid grid = make_grid(wall(3.0F), 0.1);
  const see::OcclusionTest test(grid, {.radius = 0.1, .search_distance = 10.0});
  EXPECT_FALSE(test.is_occluded({0, 0, 0}, 0.0, {0, 0, 2.5}));
  EXPECT_TRUE(test.is_occluded({0, 0, 0}, 0.0, {0, 0, 3.5}));
}

// Trap T7: a wall beyond psi is ignored, so a target behind a building counts as visible. With psi
// = d it is hidden.
TEST(OcclusionTest, IgnoresWallsBeyondSearchDistance) {
  const geometry::PointGrid grid = make_grid(wall(3.0F), 0.1);
  const Vector3d frontier(0, 0, 0), sensor(0, 0, 41);
  const see::OcclusionTest near_only(grid, {.radius = 0.1, .search_distance = 1.0});
  EXPECT_FALSE(near_only.is_occluded(frontier, 0.0, sensor));
  const see::OcclusionTest whole_line(grid, {.radius = 0.1, .search_distance = 41.0});
  EXPECT_TRUE(whole_line.is_occluded(frontier, 0.0, sensor));
}

TEST(OcclusionTest, ReachesFartherByOffsetInReleasedVariant) {
  const geometry::PointGrid grid = make_grid(wall(1.45F), 0.1);
  const Vector3d frontier(0, 0, 0), sensor(0, 0, 5);
  see::OcclusionConfig config{.radius = 0.1, .search_distance = 1.0};
  EXPECT_FALSE(see::OcclusionTest(grid, config).is_occluded(frontier, 0.5, sensor));
  config.end = see::MarchEnd::search_distance_from_offset;
  EXPECT_TRUE(see::OcclusionTest(grid, config).is_occluded(frontier, 0.5, sensor));
}

// The frontier itself is in the balls at 0 and r. The first empty ball is at 2r.
TEST(ClearOffset, IsFirstStepWithoutPoints) {
  const geometry::PointGrid grid = make_grid({{0, 0, 0}}, 0.125);  // exact in binary
  const see::OcclusionTest test(grid, {.radius = 0.125, .search_distance = 1.0});
  EXPECT_EQ(test.clear_offset({0, 0, 0}, {0, 0, 1}, 10.0), 0.25);
}

TEST(ClearOffset, IsLimitWhenNoStepIsClear) {
  std::vector<Vector3f> column;
  for (float z = 0; z < 5; z += 0.05F) column.emplace_back(0, 0, z);
  const geometry::PointGrid grid = make_grid(column, 0.1);
  const see::OcclusionTest test(grid, {.radius = 0.1, .search_distance = 1.0});
  EXPECT_EQ(test.clear_offset({0, 0, 0}, {0, 0, 1}, 10.0), 1.0);
  EXPECT_EQ(test.clear_offset({0, 0, 0}, {0, 0, 1}, 0.35), 0.35);
}

}  // namespace
}  // namespace skycap::survey
