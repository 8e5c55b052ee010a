#include "flight/clearance/segment_distance.h"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

const Eigen::AlignedBox3d around(Vector3d::Constant(-5), Vector3d::Constant(5));

/// Computes the minimum distance along a segment by ternary search. The distance of a point from a
/// convex set is convex, so it has one minimum along a segment. The accuracy is the square root of
/// machine precision.
double valley(const Segment& segment, const std::function<double(const Vector3d&)>& distance) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 100; ++i) {
    const double one = low + (high - low) / 3, two = high - (high - low) / 3;
    (distance(segment.at(one)) < distance(segment.at(two)) ? high : low) =
        distance(segment.at(one)) < distance(segment.at(two)) ? two : one;
  }
  return distance(segment.at(0.5 * (low + high)));
}

/// Computes the distance of a point from a triangle, by ternary search over the rows parallel to
/// one side.
double to_triangle(const Vector3d& point, const Triangle& triangle) {
  const Vector3d &a = triangle[0], &b = triangle[1], &c = triangle[2];
  const auto row = [&](const Vector3d& on_ab) {
    const double share = (on_ab - a).norm() / (b - a).norm();
    return std::sqrt(nearest(Segment{on_ab, c + share * (b - c)}, point).squared_distance);
  };
  return valley(Segment{a, b}, row);
}

TEST(SegmentDistance, MatchesNestedSearchForTriangles) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) {
    Triangle triangle;
    for (Vector3d& corner : triangle) corner = scenes::point_in(random, around);
    const Segment segment{scenes::point_in(random, around), scenes::point_in(random, around)};
    const NearestPoints pair = nearest(segment, triangle);
    const double searched =
        valley(segment, [&](const Vector3d& p) { return to_triangle(p, triangle); });
    // The ternary search ends where differences vanish: 1e-7 of a 10 m scene.
    EXPECT_NEAR(std::sqrt(pair.squared_distance), searched, 1e-6) << "case " << i;
  }
}

TEST(SegmentDistance, ExcludesNoNearTriangleInFastTest) {
  std::mt19937_64 random(5);
  int ruled_out = 0;
  for (int i = 0; i < 2000; ++i) {
    Triangle triangle;
    for (Vector3d& corner : triangle) corner = scenes::point_in(random, around);
    const Segment segment{scenes::point_in(random, around), scenes::point_in(random, around)};
    const double distance = std::sqrt(nearest(segment, triangle).squared_distance);
    EXPECT_TRUE(may_be_nearer(segment, triangle, distance + 1e-9));
    ruled_out += may_be_nearer(segment, triangle, 0.5 * distance) ? 0 : 1;
  }
  EXPECT_GT(ruled_out, 500);
}

TEST(SegmentDistance, ReturnsNearestPointsOnBothShapes) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 2000; ++i) {
    Triangle triangle;
    for (Vector3d& corner : triangle) corner = scenes::point_in(random, around);
    const Segment segment{scenes::point_in(random, around), scenes::point_in(random, around)};
    const NearestPoints pair = nearest(segment, triangle);
    EXPECT_NEAR((pair.on_segment - pair.on_other).squaredNorm(), pair.squared_distance, 1e-12);
    EXPECT_LT(nearest(segment, pair.on_segment).squared_distance, 1e-24);
    EXPECT_LT(nearest({pair.on_other, pair.on_other}, triangle).squared_distance, 1e-24);
  }
}

TEST(SegmentDistance, MatchesSearchForBoxes) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    Eigen::AlignedBox3d box(scenes::point_in(random, around));
    box.extend(scenes::point_in(random, around));
    const Segment segment{scenes::point_in(random, around), scenes::point_in(random, around)};
    const double searched =
        valley(segment, [&](const Vector3d& p) { return box.exteriorDistance(p); });
    EXPECT_NEAR(std::sqrt(nearest(segment, box).squared_distance), searched, 1e-6) << "case " << i;
  }
}

// Closed forms: parallel, crossing and collinear segments, and points.
TEST(SegmentDistance, IsExactForSpecialSegmentPairs) {
  const Segment x_axis{{0, 0, 0}, {10, 0, 0}};
  const auto distance = [&](const Vector3d& from, const Vector3d& to) {
    return std::sqrt(nearest(x_axis, Segment{from, to}).squared_distance);
  };
  EXPECT_DOUBLE_EQ(distance({2, 3, 0}, {8, 3, 0}), 3.0);    // parallel
  EXPECT_DOUBLE_EQ(distance({5, -1, 2}, {5, 1, 2}), 2.0);   // crossing above
  EXPECT_DOUBLE_EQ(distance({13, 0, 0}, {20, 0, 0}), 3.0);  // collinear
  EXPECT_DOUBLE_EQ(distance({-3, 4, 0}, {-3, 4, 0}), 5.0);  // a point
  EXPECT_DOUBLE_EQ(distance({4, 0, 0}, {4, 7, 0}), 0.0);    // touching
}

// Edges of 300 m at angles down to 1e-12: the error must be smaller than the clearance guard of
// 1e-6 m.
TEST(SegmentDistance, KeepsPrecisionForNearlyParallelSegments) {
  for (double angle = 1e-3; angle > 1e-12; angle /= 10.0) {
    const Segment along{{0, 0, 0}, {300, 0, 0}};
    const Vector3d tilt(0, 150 * angle, 0);
    const Segment other{Vector3d(0, 0, 2) - tilt, Vector3d(300, 0, 2) + tilt};
    EXPECT_NEAR(std::sqrt(nearest(along, other).squared_distance), 2.0, 1e-7) << angle;
  }
}

TEST(SegmentDistance, TreatsTriangleWithoutAreaAsItsEdges) {
  const Triangle needle{Vector3d(0, 0, 0), Vector3d(5, 0, 0), Vector3d(10, 0, 0)};
  const Triangle point{Vector3d(1, 1, 1), Vector3d(1, 1, 1), Vector3d(1, 1, 1)};
  const Segment segment{{7, 2, -1}, {7, 2, 1}};
  EXPECT_DOUBLE_EQ(nearest(segment, needle).squared_distance, 4.0);
  EXPECT_DOUBLE_EQ(nearest(segment, point).squared_distance, 37.0);
}

}  // namespace
}  // namespace skycap::flight
