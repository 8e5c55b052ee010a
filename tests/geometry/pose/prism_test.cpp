#include "geometry/pose/prism.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector2d;

const std::vector<Vector2d> square = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
/// Polygon with a notch that points down, so that rays from many points hit a corner.
const std::vector<Vector2d> notched = {{0, 0}, {8, 0}, {8, 8}, {4, 2}, {0, 8}};

std::vector<Vector2d> reversed(std::vector<Vector2d> polygon) {
  std::ranges::reverse(polygon);
  return polygon;
}

/// Tests for the polygon `notched` by inequalities: the square without the open triangle above the
/// tip of the notch.
bool is_in_notched(const Vector2d& p) {
  const bool is_in_square = p.x() >= 0 && p.x() <= 8 && p.y() >= 0 && p.y() <= 8;
  return is_in_square && p.y() - 2 <= 1.5 * std::abs(p.x() - 4);
}

// Coordinates are multiples of 1/2. All products are exact, so points on the border are classified
// exactly.
TEST(Contains, MatchesInequalitiesInsideOutsideAndOnBorder) {
  for (const auto& polygon : {notched, reversed(notched)}) {
    for (int i = -4; i <= 20; ++i) {
      for (int j = -4; j <= 20; ++j) {
        const Vector2d p(0.5 * i, 0.5 * j);
        EXPECT_EQ(contains(polygon, p), is_in_notched(p)) << p.transpose();
      }
    }
  }
}

TEST(Contains, IncludesPointsOnEveryEdge) {
  for (const auto& polygon : {square, reversed(square)}) {
    for (const Vector2d& p : {Vector2d(0, 5), Vector2d(10, 5), Vector2d(5, 0), Vector2d(5, 10),
                              Vector2d(0, 0), Vector2d(10, 0), Vector2d(10, 10), Vector2d(0, 10)}) {
      EXPECT_TRUE(contains(polygon, p)) << p.transpose();
    }
    EXPECT_FALSE(contains(polygon, Vector2d(10.001, 5)));
    EXPECT_FALSE(contains(polygon, Vector2d(12, 10)));  // collinear with an edge
  }
}

TEST(Prism, ContainsItsFloorAndCeiling) {
  const Prism prism{"square", square, 0, 10};
  EXPECT_TRUE(contains(prism, {0, 5, 0}));
  EXPECT_TRUE(contains(prism, {10, 10, 10}));
  EXPECT_FALSE(contains(prism, {5, 5, 10.001}));
  EXPECT_FALSE(contains(prism, {5, 5, -0.001}));
  EXPECT_TRUE(contains(Prism{.name = "", .footprint = square}, {5, 5, 1e6}));  // unbounded height
}

}  // namespace
}  // namespace skycap::geometry
