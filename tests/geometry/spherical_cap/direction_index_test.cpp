#include "geometry/spherical_cap/direction_index.h"

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> coordinate;
  return Vector3d{coordinate(random), coordinate(random), coordinate(random)}.normalized();
}

void expect_equal_to_brute_force(const std::vector<Vector3d>& directions, const Vector3d& s) {
  double largest = -2.0;
  for (const Vector3d& q : directions) largest = std::max(largest, q.dot(s));
  DirectionIndex index(directions);
  const auto nearest = index.nearest(s);
  EXPECT_EQ(nearest.cosine, largest);
  EXPECT_EQ(nearest.direction.dot(s), largest);
  EXPECT_NE(std::find(directions.begin(), directions.end(), nearest.direction), directions.end());
}

// Sets from one direction to enough for the finest grid, both spread out and in a narrow bundle.
TEST(DirectionIndex, MatchesBruteForce) {
  std::mt19937_64 random(1);
  for (const int count : {1, 2, 7, 100, 3000, 60'000}) {
    for (const double spread : {1.0, 1e-3}) {
      const Vector3d axis = random_direction(random);
      std::vector<Vector3d> directions;
      for (int i = 0; i < count; ++i) {
        const Vector3d q = random_direction(random);
        directions.push_back(spread == 1.0 ? q : Vector3d((axis + spread * q).normalized()));
      }
      for (int i = 0; i < 20; ++i) {
        expect_equal_to_brute_force(directions, random_direction(random));
        expect_equal_to_brute_force(directions, directions[random() % directions.size()]);
        expect_equal_to_brute_force(directions, -axis);
      }
    }
  }
}

// Coordinates of exactly 1 and slightly above are at the edge of the grid.
TEST(DirectionIndex, MatchesBruteForceForAxes) {
  std::vector<Vector3d> axes;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double length : {-1.0 - 5e-7, -1.0, 1.0, 1.0 + 5e-7}) {
      axes.push_back(length * Vector3d::Unit(axis));
    }
  }
  for (const Vector3d& axis : axes) expect_equal_to_brute_force(axes, axis.normalized());
}

}  // namespace
}  // namespace skycap::geometry
