#include "geometry/points/cloud_alignment.h"

#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Walls and roof of a house of 8 m x 12 m x 6 m.
std::vector<Vector3f> make_house(std::uint64_t seed, double sigma) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<Vector3f> points;
  for (int i = 0; i < 60000; ++i) {
    Vector3d point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = place(random);
    const int side = i % 5;
    const int axis = side / 2;
    point[axis] = side % 2 == 0 ? 1.0 : -1.0;
    point = point.cwiseProduct(Vector3d(4.0, 6.0, 3.0));
    point[axis] += normal(random);
    points.push_back(point.cast<float>());
  }
  return points;
}

TEST(CloudAlignment, FindsKnownOffset) {
  const std::vector<Vector3f> reference = make_house(1, 0.01);
  const Eigen::Isometry3d moved_from_reference =
      Eigen::Translation3d(0.25, -0.15, 0.1) *
      Eigen::AngleAxisd(0.02, Vector3d(0.1, 0.2, 1.0).normalized());
  std::vector<Vector3f> moved = make_house(2, 0.01);
  for (Vector3f& point : moved) point = (moved_from_reference * point.cast<double>()).cast<float>();
  const auto found = align_clouds(moved, reference, Vector3d::Zero(), 0.5, 1.0);
  ASSERT_TRUE(found.has_value());
  const Eigen::Isometry3d rest = found->correction * moved_from_reference;
  EXPECT_LT(rest.translation().norm(), 0.005);
  EXPECT_LT(Eigen::AngleAxisd(rest.linear()).angle(), 0.001);
  EXPECT_GT(found->first_error, 0.03);
  EXPECT_LT(found->error, 0.01);
}

TEST(CloudAlignment, FindsNoOffsetBetweenAlignedClouds) {
  const auto found =
      align_clouds(make_house(1, 0.01), make_house(2, 0.01), Vector3d::Zero(), 0.5, 1.0);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(found->correction.translation().norm(), 0.003);
}

TEST(CloudAlignment, FindsNothingInCommonFarAway) {
  std::vector<Vector3f> moved = make_house(2, 0.01);
  for (Vector3f& point : moved) point += Vector3f(500.0F, 0.0F, 0.0F);
  EXPECT_FALSE(align_clouds(moved, make_house(1, 0.01), Vector3d::Zero(), 0.5, 1.0).has_value());
}

}  // namespace
}  // namespace skycap::geometry
