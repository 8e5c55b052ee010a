#include "geometry/surfaces/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

// Coordinates are of the order of 1 and distances are square roots of sums of products of them.
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

/// Distance to a triangle: to the plane if the foot is inside, otherwise to the nearest edge.
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

TEST(MeshDistance, OfPointsEqualsBruteForce) {
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

// The distance is 1-Lipschitz along the segment, so dense samples of it bound the smallest one from
// above, and half a sample spacing less bounds it from below.
TEST(MeshDistance, OfSegmentsAgreesWithDenseSamples) {
  std::mt19937_64 random(2);
  const Mesh mesh = random_soup(random, 150);
  const MeshDistance surface(mesh);
  int cutting = 0;
  for (int i = 0; i < 100; ++i) {
    const Vector3d from = random_point(random, 3.0), to = random_point(random, 3.0);
    const double found = surface.distance(from, to);
    double sampled = std::numeric_limits<double>::infinity();
    constexpr int samples = 300;
    for (int s = 0; s <= samples; ++s) {
      sampled = std::min(sampled, surface.distance(from + (to - from) * (double(s) / samples)));
    }
    EXPECT_LE(found, sampled + rounding);
    EXPECT_GE(found, sampled - 0.5 * (to - from).norm() / samples - rounding);
    cutting += found == 0.0;
  }
  EXPECT_GT(cutting, 5);  // both kinds occur
  EXPECT_LT(cutting, 95);
}

TEST(MeshDistance, HasTheAnswersOfASquare) {
  const Mesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                    {{0, 1, 2}, {0, 2, 3}, {0, 1, 1}}};
  const MeshDistance surface(square);
  EXPECT_DOUBLE_EQ(surface.distance({0.3, 0.6, -2}), 2.0);
  EXPECT_DOUBLE_EQ(surface.distance({4, 5, 0}), 5.0);
  EXPECT_EQ(surface.closest({0.9, 0.1, 7}).triangle, 0U);
  EXPECT_EQ(surface.distance({0.5, 0.2, 1}, {0.5, 0.2, -1}), 0.0);
  EXPECT_DOUBLE_EQ(surface.distance({-1, 0.5, 0.5}, {2, 0.5, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(surface.distance({2, -5, 1}, {2, 5, 1}), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(surface.distance({2, 0, 0}, {2, 0, 0}), 1.0);
}

TEST(MeshDistance, RefusesAMeshWithoutSurface) { EXPECT_THROW(MeshDistance(Mesh{}), Error); }

}  // namespace
}  // namespace skycap::geometry
