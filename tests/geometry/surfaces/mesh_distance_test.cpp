#include "geometry/surfaces/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/support/complaint.h"
#include "tests/support/instruction_sets.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

// Coordinates are of the order of 1, and distances are square roots of sums of their products.
constexpr double rounding = 1e-9;

Vector3d random_point(std::mt19937_64& random, double range) {
  std::uniform_real_distribution<double> coordinate(-range, range);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

Mesh random_soup(std::mt19937_64& random, int triangles) {
  Mesh mesh;
  for (int t = 0; t < triangles; ++t) {
    const Vector3d centre = random_point(random, 2.0);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i < 3; ++i) mesh.vertices.push_back(centre + random_point(random, 0.3));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// Returns the distance to a triangle: to the plane if the foot point is inside, otherwise to the
/// nearest edge.
double distance_to_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                            const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const auto is_left = [&](const Vector3d& from, const Vector3d& to) {
    return normal.dot((to - from).cross(p - from)) >= 0.0;
  };
  if (is_left(a, b) && is_left(b, c) && is_left(c, a)) return std::abs(normal.dot(p - a));
  const auto to_edge = [&](const Vector3d& from, const Vector3d& to) {
    const Vector3d edge = to - from;
    const double t = std::clamp((p - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    return (p - from - t * edge).norm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

double brute_force(const Mesh& mesh, const Vector3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    nearest = std::min(
        nearest, distance_to_triangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
  }
  return nearest;
}

TEST(MeshDistance, MatchesBruteForceForPoints) {
  std::mt19937_64 random(1);
  const Mesh mesh = random_soup(random, 300);
  const MeshDistance surface(mesh);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = random_point(random, 3.0);
    const auto closest = surface.closest(p);
    EXPECT_NEAR(closest.distance, brute_force(mesh, p), rounding);
    EXPECT_NEAR((closest.point - p).norm(), closest.distance, rounding);
    const auto& [a, b, c] = mesh.triangles[closest.triangle];
    EXPECT_NEAR(
        distance_to_triangle(closest.point, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]),
        0.0, rounding);
  }
}

/// Compares batched distances with distances of single points, with each instruction set.
void expect_single_point_distances(const Mesh& mesh, const std::vector<Eigen::Vector3f>& points) {
  const MeshDistance surface(mesh);
  for (const InstructionSet widest : instruction_sets()) {
    const InstructionSetLimit limit(widest);
    std::vector<double> distances(points.size());
    surface.distances(points, distances, 2);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(distances[i], surface.distance(points[i].cast<double>())) << i;
    }
  }
}

// Points in scan order, in random order, far away, and on corners and edges.
TEST(MeshDistance, MatchesSinglePointDistancesForManyPoints) {
  std::mt19937_64 random(2);
  const Mesh mesh = random_soup(random, 200);
  std::vector<Eigen::Vector3f> points;
  points.reserve(1500 + mesh.vertices.size());
  for (int i = 0; i < 500; ++i) points.push_back(random_point(random, 3.0).cast<float>());
  for (int i = 0; i < 500; ++i) points.emplace_back(0.01F * float(i) - 2.5F, 0.3F, 0.1F);
  for (int i = 0; i < 500; ++i) points.push_back(random_point(random, 200.0).cast<float>());
  for (const Vector3d& vertex : mesh.vertices) points.push_back(vertex.cast<float>());
  expect_single_point_distances(mesh, points);
}

TEST(MeshDistance, MatchesSinglePointDistancesForFewPoints) {
  std::mt19937_64 random(6);
  const Mesh mesh = random_soup(random, 3);
  for (const int count : {0, 1, 15, 17}) {
    std::vector<Eigen::Vector3f> points;
    points.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) points.push_back(random_point(random, 3.0).cast<float>());
    expect_single_point_distances(mesh, points);
  }
}

// Boxes have single precision, which rounds to millimetres here. Distances must not be affected.
TEST(MeshDistance, IsExactFarFromOrigin) {
  std::mt19937_64 random(3);
  Mesh mesh = random_soup(random, 300);
  const Vector3d there(15000.0, -12000.0, 300.0);
  for (Vector3d& vertex : mesh.vertices) vertex += there;
  const MeshDistance surface(mesh);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = there + random_point(random, 3.0);
    EXPECT_NEAR(surface.distance(p), brute_force(mesh, p), 1e-7);
  }
}

// The distance of a needle triangle, 1 m long and 1 nm thick, equals that of its edges.
TEST(MeshDistance, MatchesEdgeDistancesForNeedleTriangles) {
  std::mt19937_64 random(4);
  Mesh needles;
  for (int i = 0; i < 50; ++i) {
    const Vector3d from = random_point(random, 2.0), to = random_point(random, 2.0);
    const auto first = static_cast<std::uint32_t>(needles.vertices.size());
    const Vector3d near_middle = 0.5 * (from + to) + 1e-9 * random_point(random, 1.0);
    needles.vertices.insert(needles.vertices.end(), {from, near_middle, to});
    needles.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshDistance surface(needles);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 200; ++i) {
    const Vector3d p = random_point(random, 3.0);
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : needles.triangles) {
      const Vector3d edge = needles.vertices[c] - needles.vertices[a];
      const Vector3d from_a = p - needles.vertices[a];
      const double t = std::clamp(from_a.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (from_a - t * edge).norm());
    }
    EXPECT_NEAR(surface.distance(p), nearest, 1e-8);
    points.push_back(p.cast<float>());
  }
  expect_single_point_distances(needles, points);
}

TEST(MeshDistance, ReturnsFirstOfEquallyNearTriangles) {
  const Mesh fan{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}};
  EXPECT_EQ(MeshDistance(fan).closest({0, 0, 1}).triangle, 0U);
  EXPECT_EQ(MeshDistance(fan).closest({-0.25, 0, 1}).triangle, 1U);
}

// Compares with dense samples: between them the distance changes by at most half the spacing.
TEST(MeshDistance, DetectsPathsThatKeepDistance) {
  std::mt19937_64 random(5);
  const Mesh mesh = random_soup(random, 60);
  const MeshDistance surface(mesh);
  int kept = 0, rejected = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d from = random_point(random, 3.0), to = random_point(random, 3.0);
    double nearest = std::numeric_limits<double>::infinity();
    constexpr int samples = 200;
    for (int s = 0; s <= samples; ++s) {
      nearest = std::min(nearest, surface.distance(from + (to - from) * (double(s) / samples)));
    }
    const double between = 0.5 * (to - from).norm() / samples;
    constexpr double distance = 0.2;
    if (surface.keeps(from, to, distance)) {
      ++kept;
      EXPECT_GE(nearest, distance);
    } else {
      ++rejected;
      EXPECT_LE(nearest - between, distance * 1.002);
    }
  }
  EXPECT_GT(kept, 20);
  EXPECT_GT(rejected, 20);
}

TEST(MeshDistance, MatchesKnownDistancesToSquare) {
  const Mesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                    {{0, 1, 2}, {0, 2, 3}, {0, 1, 1}}};
  const MeshDistance surface(square);
  EXPECT_DOUBLE_EQ(surface.distance({0.3, 0.6, -2}), 2.0);
  EXPECT_DOUBLE_EQ(surface.distance({4, 5, 0}), 5.0);
  EXPECT_EQ(surface.closest({0.9, 0.1, 7}).triangle, 0U);
}

TEST(MeshDistance, IsFiniteForCoordinatesBeyondSinglePrecision) {
  for (const double far_off : {1e37, 1e39, 1e60}) {
    Mesh mesh;
    for (int i = 0; i < 200; ++i) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      const double z = (i - 100) * 1e-2 * far_off;
      mesh.vertices.insert(mesh.vertices.end(),
                           {{-far_off, -far_off, z}, {far_off, -z, far_off}, {z, far_off, -z}});
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    const MeshDistance distance(mesh);
    for (const double x : {0.0, 1.0, 0.5 * far_off, 2.0 * far_off}) {
      EXPECT_TRUE(std::isfinite(distance.distance({x, 0.0, -x}))) << far_off << " " << x;
    }
  }
}

TEST(MeshDistance, RejectsMeshWithoutSurface) {
  EXPECT_THAT(testing_support::thrown_message([&] { MeshDistance(Mesh{}); }),
              testing::HasSubstr("the mesh contains no triangle with a positive area"));
}

}  // namespace
}  // namespace skycap::geometry
