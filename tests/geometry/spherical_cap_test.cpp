#include "geometry/spherical_cap.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Directions = std::vector<Vector3d>;

// The exact methods compute with unit vectors in double precision; facets of well-spread points
// lose at most a few digits of 1e-16.
constexpr double rounding = 1e-12;

Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> coordinate;
  return Vector3d(coordinate(random), coordinate(random), coordinate(random)).normalized();
}

double h(const Directions& occluded, const Vector3d& s) {
  double largest = -1.0;
  for (const Vector3d& q : occluded) largest = std::max(largest, q.dot(s));
  return largest;
}

Directions octahedron() {
  return {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
}

Directions tetrahedron() {
  const double a = 1.0 / std::sqrt(3.0);
  return {{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}};
}

/// `count` directions at the angle `polar` from +z.
Directions ring(double polar, int count) {
  Directions directions;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / count;
    directions.emplace_back(std::sin(polar) * std::cos(azimuth),
                            std::sin(polar) * std::sin(azimuth), std::cos(polar));
  }
  return directions;
}

class ExactCap : public testing::TestWithParam<CapPolicy> {
 protected:
  SphericalCap cap(const Directions& occluded, const Vector3d& known_clear) const {
    const auto result = clearest_direction(occluded, known_clear, {GetParam()});
    EXPECT_TRUE(result);
    EXPECT_NEAR(result->direction.norm(), 1.0, rounding);
    return *result;
  }
};
INSTANTIATE_TEST_SUITE_P(Policies, ExactCap, testing::Values(CapPolicy::local, CapPolicy::global),
                         [](const auto& policy) {
                           return policy.param == CapPolicy::local ? "Local" : "Global";
                         });

TEST_P(ExactCap, OctahedronGivesTheFacetOnTheClearSide) {
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        const Vector3d middle = Vector3d(x, y, z) / std::sqrt(3.0);
        const auto found = cap(octahedron(), (middle + Vector3d(0.1, 0.2, -0.1)).normalized());
        EXPECT_LT((found.direction - middle).norm(), rounding);
        EXPECT_NEAR(found.cosine, 1.0 / std::sqrt(3.0), rounding);
      }
    }
  }
}

TEST_P(ExactCap, TetrahedronGivesAFacet) {
  for (const Vector3d& vertex : tetrahedron()) {
    const auto found = cap(tetrahedron(), (Vector3d(0.1, 0.2, 0.3) - vertex).normalized());
    EXPECT_NEAR(found.cosine, 1.0 / 3.0, rounding);
    EXPECT_LT((found.direction + vertex).norm(), rounding);
  }
}

TEST_P(ExactCap, RingAboveTheEquatorGivesTheFarPole) {
  const auto found = cap(ring(std::numbers::pi / 3.0, 50), Vector3d::UnitX());
  EXPECT_LT((found.direction + Vector3d::UnitZ()).norm(), rounding);
  EXPECT_NEAR(found.cosine, -0.5, rounding);
}

TEST_P(ExactCap, GreatCircleGivesThePoleOnTheClearSide) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.2, 0.8, 0.4).normalized();
  Directions circle = ring(std::numbers::pi / 2.0, 37);
  for (Vector3d& q : circle) q = turn * q;
  for (const double side : {-1.0, 1.0}) {
    const Vector3d pole = turn * Vector3d(0, 0, side);
    const auto found = cap(circle, (pole + turn * Vector3d(2, 1, 0)).normalized());
    EXPECT_LT((found.direction - pole).norm(), rounding);
    EXPECT_NEAR(found.cosine, 0.0, rounding);
  }
}

TEST_P(ExactCap, ClosedHemisphereGivesItsPole) {
  Directions half = ring(std::numbers::pi / 2.0, 24);
  for (const double polar : {0.3, 0.8, 1.2}) {
    const Directions more = ring(polar, 24);
    half.insert(half.end(), more.begin(), more.end());
  }
  const auto found = cap(half, Vector3d(0.9, 0.1, 0.2).normalized());
  EXPECT_LT((found.direction + Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(found.cosine, 0.0, rounding);
}

TEST_P(ExactCap, SingleDirectionGivesItsAntipode) {
  const Vector3d q = Vector3d(1, 2, 3).normalized();
  EXPECT_LT((cap({q}, Vector3d::UnitX()).direction + q).norm(), rounding);
  EXPECT_LT((cap(Directions(500, q), Vector3d::UnitX()).direction + q).norm(), rounding);
}

TEST_P(ExactCap, AntipodalPairGivesTheNearestDirectionAtRightAngles) {
  const Vector3d q = Vector3d(1, 2, 3).normalized();
  const Vector3d clear = Vector3d(1, 0, 1).normalized();
  const auto found = cap({q, -q, q, -q}, clear);
  EXPECT_NEAR(found.cosine, 0.0, rounding);
  EXPECT_LT((found.direction - (clear - clear.dot(q) * q).normalized()).norm(), rounding);
  // Without a nearest one, any will do.
  EXPECT_NEAR(cap({q, -q}, q).direction.dot(q), 0.0, rounding);
}

TEST_P(ExactCap, CoplanarDirectionsGiveTheAxisOfTheirCircle) {
  const auto found = cap(ring(2.5, 3), Vector3d::UnitX());
  EXPECT_LT((found.direction - Vector3d::UnitZ()).norm(), rounding);
  EXPECT_NEAR(found.cosine, std::cos(2.5), rounding);
}

TEST_P(ExactCap, EmptySetGivesTheClearDirection) {
  const auto found = cap({}, Vector3d::UnitY());
  EXPECT_EQ(found.direction, Vector3d::UnitY());
  EXPECT_EQ(found.cosine, -1.0);
}

TEST_P(ExactCap, DuplicatesChangeNothing) {
  std::mt19937_64 random(3);
  Directions once, thrice;
  for (int i = 0; i < 60; ++i) once.push_back(random_direction(random));
  for (int copy = 0; copy < 3; ++copy) thrice.insert(thrice.end(), once.begin(), once.end());
  const Vector3d clear = random_direction(random);
  EXPECT_LT((cap(once, clear).direction - cap(thrice, clear).direction).norm(), rounding);
}

TEST_P(ExactCap, NoDirectionAroundTheFoundOneIsClearer) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    Directions occluded;
    for (int i = 0; i < 200; ++i) occluded.push_back(random_direction(random));
    const auto found = cap(occluded, random_direction(random));
    EXPECT_NEAR(found.cosine, h(occluded, found.direction), rounding);
    for (int i = 0; i < 50; ++i) {
      const Vector3d near = (found.direction + 1e-4 * random_direction(random)).normalized();
      EXPECT_GT(h(occluded, near), found.cosine - rounding);
    }
  }
}

}  // namespace
}  // namespace skycap::geometry
