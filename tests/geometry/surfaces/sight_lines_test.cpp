#include "geometry/surfaces/sight_lines.h"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "geometry/random_numbers.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

/// Returns random triangles in a cube with side 10.
Mesh random_mesh(std::size_t count, std::uint64_t seed) {
  RandomNumbers random(seed);
  Mesh mesh;
  const auto point = [&](double low, double high) {
    return Vector3d{random.between(low, high), random.between(low, high),
                    random.between(low, high)};
  };
  for (std::uint32_t t = 0; t < count; ++t) {
    const Vector3d corner = point(0.0, 10.0);
    mesh.vertices.insert(mesh.vertices.end(),
                         {corner, corner + point(-1.0, 1.0), corner + point(-1.0, 1.0)});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

/// Returns the distance to the first triangle by solving o + t d = a + u ab + v ac for each
/// triangle.
std::optional<double> brute_force(const Mesh& mesh, const Vector3d& origin,
                                  const Vector3d& direction, double max_distance) {
  std::optional<double> first;
  for (const auto& [a, b, c] : mesh.triangles) {
    Eigen::Matrix3d system;
    system << -direction, mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a];
    const Vector3d found = system.fullPivLu().solve(origin - mesh.vertices[a]);
    if (found.y() < 0.0 || found.z() < 0.0 || found.y() + found.z() > 1.0) continue;
    if (found.x() > 0.0 && found.x() < first.value_or(max_distance)) first = found.x();
  }
  return first;
}

TEST(SightLines, FindTheFirstTriangleAsBruteForceDoes) {
  const Mesh mesh = random_mesh(300, 3);
  const SightLines visible_targets(mesh, 2);
  RandomNumbers random(4);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d origin{random.between(-2, 12), random.between(-2, 12), random.between(-2, 12)};
    const Vector3d target{random.between(0, 10), random.between(0, 10), random.between(0, 10)};
    const Vector3d direction = (target - origin).normalized();
    const auto expected = brute_force(mesh, origin, direction, 20.0);
    const auto found = visible_targets.first_hit(origin, direction, 20.0);
    ASSERT_EQ(found.has_value(), expected.has_value()) << i;
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(*found, *expected, 1e-9) << i;
    EXPECT_FALSE(visible_targets.is_clear(origin, origin + (*found + 0.1) * direction, 1.0));
    EXPECT_TRUE(visible_targets.is_clear(origin, origin + *found * direction, 0.999));
  }
  EXPECT_GT(hits, 500);
}

TEST(SightLines, SeeAlongAxesOfABox) {
  Mesh wall;
  wall.vertices = {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  const SightLines visible_targets(wall, 1);
  EXPECT_DOUBLE_EQ(visible_targets.first_hit({-3, 0, 0}, Vector3d::UnitX(), 10.0).value(), 3.0);
  EXPECT_DOUBLE_EQ(visible_targets.first_hit({3, 0.5, 0.5}, -Vector3d::UnitX(), 10.0).value(), 3.0);
  EXPECT_FALSE(visible_targets.first_hit({-3, 0, 0}, Vector3d::UnitX(), 2.9));
  EXPECT_FALSE(visible_targets.first_hit({-3, 0, 0}, Vector3d::UnitY(), 10.0));
  EXPECT_FALSE(visible_targets.first_hit({-3, 1.5, 0}, Vector3d::UnitX(), 10.0));
}

TEST(SightLines, AreNotObstructedByAnEmptyMesh) {
  const SightLines visible_targets(Mesh{}, 1);
  EXPECT_TRUE(visible_targets.is_clear({0, 0, 0}, {1, 2, 3}, 1.0));
  EXPECT_FALSE(visible_targets.first_hit({0, 0, 0}, Vector3d::UnitX(), 1e9));
}

}  // namespace
}  // namespace skycap::geometry
