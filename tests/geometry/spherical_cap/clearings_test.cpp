#include "geometry/spherical_cap/clearings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/spherical_cap/spherical_cap_methods.h"
#include "tests/geometry/spherical_cap/directions.h"
#include "tests/support/not_empty.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

/// Directions distributed over the whole sphere, so that the largest empty cap is small. There are
/// more than the few with which global caps start before they discard any.
enum class Spread {
  random,
  jittered,      // roughly equidistant, as samplers create them
  denser_north,  // one hemisphere has ten times the density
  // Rows of latitude: many coplanar directions, many equal caps, clusters at the poles.
  rows,
  spiral,  // nearly all caps are equal
  make_cube_faces,
  thrice,       // each direction three times
  off_by_1e_6,  // lengths with the maximum deviation from 1
};
constexpr Spread all_spreads[] = {Spread::random, Spread::jittered,   Spread::denser_north,
                                  Spread::rows,   Spread::spiral,     Spread::make_cube_faces,
                                  Spread::thrice, Spread::off_by_1e_6};

Directions spiral(int count) {
  Directions directions;
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(turn * i), r * std::sin(turn * i), z);
  }
  return directions;
}

Directions rows(int count) {
  Directions directions{Vector3d::UnitZ(), -Vector3d::UnitZ()};
  for (int row = 1; row < count; ++row) {
    for (int column = 0; column < 2 * count; ++column) {
      const double polar = std::numbers::pi * row / count;
      const double azimuth = std::numbers::pi * column / count;
      directions.emplace_back(std::sin(polar) * std::cos(azimuth),
                              std::sin(polar) * std::sin(azimuth), std::cos(polar));
    }
  }
  return directions;
}

Directions make_cube_faces(int edge) {
  Directions directions;
  for (int axis = 0; axis < 3; ++axis) {
    for (int u = 0; u <= edge; ++u) {
      for (int v = 0; v <= edge; ++v) {
        Vector3d on_cube;
        on_cube[axis] = 1.0;
        on_cube[(axis + 1) % 3] = 2.0 * u / edge - 1.0;
        on_cube[(axis + 2) % 3] = 2.0 * v / edge - 1.0;
        directions.push_back(on_cube.normalized());
        directions.push_back(-directions.back());
      }
    }
  }
  return directions;
}

Directions spread_out(Spread spread, std::mt19937_64& random) {
  Directions directions;
  if (spread == Spread::rows) return rows(30);
  if (spread == Spread::spiral) return spiral(1500);
  if (spread == Spread::make_cube_faces) return make_cube_faces(16);
  if (spread == Spread::jittered) {
    directions = spiral(1500);
    for (Vector3d& q : directions) q = (q + 0.02 * random_direction(random)).normalized();
    return directions;
  }
  std::uniform_real_distribution<double> part(0.0, 1.0), length(1.0 - 1e-6, 1.0 + 1e-6);
  while (directions.size() < 1500) {
    Vector3d q = random_direction(random);
    if (spread == Spread::denser_north && q.z() < 0.0 && part(random) > 0.1) continue;
    if (spread == Spread::off_by_1e_6) q *= length(random);
    directions.insert(directions.end(), spread == Spread::thrice ? 3 : 1, q);
  }
  return directions;
}

struct Facet {
  Vector3d normal;
  double offset;
};

/// Returns the facets of the hull of all directions, computed by CGAL. Facets that are too thin for
/// a reliable normal are skipped.
std::vector<Facet> hull_facets(const Directions& directions) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  for (const Vector3d& q : directions) points.emplace_back(q.x(), q.y(), q.z());
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  std::vector<Facet> facets;
  for (const auto face : hull.faces()) {
    Directions corners;
    for (const auto v : hull.vertices_around_face(hull.halfedge(face))) {
      corners.emplace_back(hull.point(v).x(), hull.point(v).y(), hull.point(v).z());
    }
    const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (normal.norm() < 1e-9) continue;
    facets.push_back({normal.normalized(), normal.normalized().dot(corners[0])});
  }
  return facets;
}

double smallest_offset(const std::vector<Facet>& facets) {
  return std::min_element(facets.begin(), facets.end(),
                          [](const Facet& a, const Facet& b) { return a.offset < b.offset; })
      ->offset;
}

bool is_in_a_part(const Clearings& clearings, const Vector3d& s) {
  return std::any_of(clearings.parts.begin(), clearings.parts.end(), [&](const SpherePart& part) {
    return (part.centre - s).norm() <= part.radius + 1e-12;
  });
}

class EvenSphere : public testing::TestWithParam<Spread> {};
INSTANTIATE_TEST_SUITE_P(Spreads, EvenSphere, testing::ValuesIn(all_spreads));

// The result does not depend on the start of the search: caps that do not exist, little
// information, or the solution.
TEST_P(EvenSphere, HasAllClearCapsInsideClearings) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 3; ++trial) {
    const Directions occluded = spread_out(GetParam(), random);
    const auto facets = hull_facets(occluded);
    const double best = smallest_offset(facets);
    DirectionIndex index(occluded);
    for (const double start : {0.5, h(occluded, random_direction(random)), best}) {
      const Clearings clearings = find_clearings(index, start);
      EXPECT_LE(clearings.cosine, start);
      EXPECT_TRUE(clearings.cosine == start || clearings.cosine >= best - 1e-12);
      for (const Facet& facet : testing_support::not_empty(facets)) {
        if (facet.offset > clearings.cosine + cap_tolerance) continue;
        EXPECT_TRUE(is_in_a_part(clearings, facet.normal)) << facet.offset - best;
        EXPECT_TRUE(clearings.meet(facet.normal, 1.0));
      }
      for (int i = 0; i < 500; ++i) {
        const Vector3d s = random_direction(random);
        if (is_in_a_part(clearings, s)) continue;
        EXPECT_GT(h(occluded, s), clearings.cosine + cap_tolerance - 1e-12);
      }
    }
  }
}

TEST_P(EvenSphere, MatchesFullHullForLargestCap) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 3; ++trial) {
    const Directions occluded = spread_out(GetParam(), random);
    const auto found = clearest_direction(occluded, Vector3d::UnitX(), {CapPolicy::global});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->cosine, h(occluded, found->direction), 1e-12);
    // A cap within cap_tolerance of the largest is accepted.
    EXPECT_NEAR(found->cosine, smallest_offset(hull_facets(occluded)), 2.0 * cap_tolerance);
  }
}

// Among all caps that equal the largest within the tolerance, no hull facet is closer to the clear
// direction than the result.
TEST_P(EvenSphere, SelectsCapNearestToClearDirectionWhenEqual) {
  std::mt19937_64 random(3);
  const Directions occluded = spread_out(GetParam(), random);
  const auto facets = hull_facets(occluded);
  const double best = smallest_offset(facets);
  for (int trial = 0; trial < 5; ++trial) {
    const Vector3d clear = random_direction(random);
    const auto found = clearest_direction(occluded, clear, {CapPolicy::global});
    ASSERT_TRUE(found);
    for (const Facet& facet : testing_support::not_empty(facets)) {
      if (facet.offset > best + 0.5 * cap_tolerance) continue;
      EXPECT_LE(facet.normal.dot(clear), found->direction.dot(clear) + 10.0 * cap_tolerance);
    }
  }
}

TEST(Clearings, AreFewAndSmallOnRandomSphere) {
  std::mt19937_64 random(4);
  Directions occluded;
  for (int i = 0; i < 20'000; ++i) occluded.push_back(random_direction(random));
  DirectionIndex index(occluded);
  const Clearings clearings = find_clearings(index, h(occluded, Vector3d::UnitX()));
  ASSERT_THAT(clearings.parts, testing::SizeIs(testing::AllOf(testing::Gt(0), testing::Le(300))));
  const double cap_radius = std::sqrt(2.0 - 2.0 * clearings.cosine);
  for (const SpherePart& part : clearings.parts) EXPECT_LT(part.radius, 0.2 * cap_radius);
}

TEST(Clearings, AreWholeSphereForManyEqualCaps) {
  const Directions occluded = spiral(20'000);
  DirectionIndex index(occluded);
  const Clearings clearings = find_clearings(index, h(occluded, Vector3d::UnitX()));
  ASSERT_THAT(clearings.parts, testing::SizeIs(1));
  EXPECT_EQ(clearings.parts[0].radius, 2.0);
  for (const Vector3d& s : {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(-1, 0, 0)}) {
    EXPECT_TRUE(clearings.meet(s, 1.0));
  }
}

TEST(Clearings, IntersectCapsThatReachThem) {
  const Clearings clearings{{{Vector3d::UnitX(), 0.1}, {Vector3d::UnitZ(), 0.1}}, 0.9};
  const auto cap_at = [](double angle) {
    // A cap of chord radius 0.2, at this angle from the first clearing.
    return Vector3d(std::cos(angle), std::sin(angle), 0.0);
  };
  const double cosine = 1.0 - 0.5 * 0.2 * 0.2;
  const auto chord_angle = [](double chord) { return 2.0 * std::asin(0.5 * chord); };
  EXPECT_TRUE(clearings.meet(cap_at(chord_angle(0.299)), cosine));
  EXPECT_FALSE(clearings.meet(cap_at(chord_angle(0.301)), cosine));
  EXPECT_TRUE(clearings.meet(Vector3d(0.0, 0.2, 1.0).normalized(), cosine));
}

}  // namespace
}  // namespace skycap::geometry
