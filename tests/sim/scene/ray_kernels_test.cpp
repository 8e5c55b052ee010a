#include "sim/scene/ray_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <embree3/rtcore.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/scene/ray_tree.h"
#include "tests/sim/shapes.h"
#include "tests/sim/triangle_soup.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/not_empty.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::Mesh;

/// Returns rays at decision boundaries: through corners, along edges, in the plane of triangles,
/// and from inside that plane.
std::vector<SingleRay> hard_rays(const Mesh& mesh, std::mt19937_64& random, std::size_t count) {
  std::vector<SingleRay> rays;
  std::uniform_int_distribution<std::size_t> any(1, mesh.triangles.size() - 1);
  std::uniform_real_distribution<float> share(-0.2F, 1.2F);
  const auto corner = [&](std::size_t triangle, int which) -> Vector3f {
    return mesh.vertices[mesh.triangles[triangle][which]].cast<float>();
  };
  while (rays.size() < count) {
    const std::size_t triangle = any(random);
    const Vector3f a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
    const Vector3f inside = a + share(random) * (b - a) + share(random) * (c - a);
    const Vector3f away = random_point(random, 8.0F), edge = a + share(random) * (b - a);
    rays.push_back(ray(away, inside - away));
    rays.push_back(ray(away, a - away));
    rays.push_back(ray(away, edge - away));
    rays.push_back(ray(inside, away));                    // starts on the triangle
    rays.push_back(ray(a + 3.0F * (a - b), b - a));       // along an edge
    rays.push_back(ray(inside + 2.0F * (b - c), c - b));  // in the triangle's plane
    Vector3f along_axis = Vector3f::Zero();
    along_axis[static_cast<int>(triangle % 3)] = triangle % 2 == 0 ? 1.0F : -1.0F;
    rays.push_back(ray(inside - 5.0F * along_axis, along_axis));
  }
  return rays;
}

// The nearest hit equals the nearest of all triangles tested one by one. Among equal distances, the
// smallest index wins. Neither the tree nor the order of visits changes it, bit for bit.
TEST(RayKernels, MatchNearestHitOfAllSingleTriangles) {
  std::mt19937_64 random(1);
  const Mesh mesh = random_soup(random, 150);
  const Triangles all(mesh);
  std::vector<std::unique_ptr<Triangles>> each;
  for (const auto& triangle : mesh.triangles) {
    each.push_back(
        std::make_unique<Triangles>(Mesh{mesh.vertices, {triangle, mesh.triangles.front()}}));
  }
  int hits = 0, ties = 0;
  for (const SingleRay& asked : hard_rays(mesh, random, 4000)) {
    float nearest = infinity;
    std::uint32_t expected = 0;
    for (std::uint32_t i = 0; i < each.size(); ++i) {
      const float distance = cast(*each[i], asked).distance;
      if (distance < 0.0F || distance > nearest) continue;
      if (distance == nearest) {
        ++ties;
        continue;
      }
      nearest = distance;
      expected = i;
    }
    const SingleRay hit = cast(all, asked);
    ASSERT_EQ(hit.distance, nearest == infinity ? -1.0F : nearest);
    if (hit.distance < 0.0F) continue;
    ++hits;
    ASSERT_EQ(hit.triangle, expected);
    // The maximum distance is exact to the last bit.
    EXPECT_EQ(cast(all, asked, nearest).distance, nearest);
    EXPECT_LT(cast(all, asked, std::nextafter(nearest, -1.0F)).distance, 0.0F);
    EXPECT_TRUE(ray_kernels().is_blocked(all.target(), asked, nearest));
    EXPECT_FALSE(ray_kernels().is_blocked(all.target(), asked, std::nextafter(nearest, -1.0F)));
  }
  EXPECT_GT(hits, 2500);
  EXPECT_GT(ties, 50);
}

// Single rays and packets with any other rays are bitwise equal on every instruction set.
TEST(RayKernels, MatchSingleRaysInPacketsOnAllInstructionSets) {
  std::mt19937_64 random(2);
  const Mesh mesh = random_soup(random, 3000);
  const Triangles triangles(mesh);
  std::vector<SingleRay> rays = hard_rays(mesh, random, 20'000);
  std::shuffle(rays.begin(), rays.end(), random);
  std::vector<SingleRay> expected = rays;
  for (SingleRay& each : expected) {
    baseline_ray_kernels.cast_single(triangles.target(), each, infinity);
  }
  for (const geometry::InstructionSet set : testing_support::not_empty(instruction_sets())) {
    const InstructionSetLimit limit(set);
    for (std::size_t first = 0; first + RayPacket::width <= rays.size();
         first += RayPacket::width) {
      RayPacket packet, distances, some;
      for (int lane = 0; lane < RayPacket::width; ++lane) {
        for (int axis = 0; axis < 3; ++axis) {
          packet.origin[axis][lane] = rays[first + lane].origin[axis];
          packet.direction[axis][lane] = rays[first + lane].direction[axis];
        }
      }
      some = distances = packet;
      const auto lanes = static_cast<std::uint32_t>(random() & RayPacket::all_lanes);
      ray_kernels().cast(triangles.target(), packet, RayPacket::all_lanes, infinity);
      ray_kernels().cast(triangles.target(), some, lanes, infinity);
      ray_kernels().cast_tile_distances(triangles.target(), &distances, 1, infinity);
      // A maximum distance that excludes some of the hits.
      constexpr float reach = 0.5F;
      const std::uint32_t blocked = ray_kernels().blocked(triangles.target(), packet, lanes, reach);
      for (int lane = 0; lane < RayPacket::width; ++lane) {
        const SingleRay& one = expected[first + lane];
        const bool is_asked = (lanes >> lane & 1U) != 0;
        ASSERT_EQ(packet.distance[lane], one.distance) << static_cast<int>(set);
        ASSERT_EQ(some.distance[lane], is_asked ? one.distance : -1.0F);
        ASSERT_EQ(distances.distance[lane], one.distance);
        ASSERT_EQ(cast(triangles, rays[first + lane]).distance, one.distance);
        ASSERT_EQ((blocked >> lane & 1U) != 0,
                  is_asked && one.distance >= 0.0F && one.distance <= reach);
        if (one.distance < 0.0F) continue;
        ASSERT_EQ(packet.triangle[lane], one.triangle);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_EQ(packet.normal[axis][lane], one.normal[axis]);
        }
      }
    }
  }
}

std::int64_t volume(const std::array<std::int64_t, 3>& a, const std::array<std::int64_t, 3>& b,
                    const std::array<std::int64_t, 3>& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// Exact reference: with integer coordinates, the volumes that decide on which side of an edge a ray
// passes are integers. If none is zero, the result is certain. The error of the shear is about 1e-6
// of the coordinates, less than the distance between edges and rays that miss.
TEST(RayKernels, MatchExactIntegerArithmetic) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<std::int64_t> coordinate(-20, 20);
  using Point = std::array<std::int64_t, 3>;
  const auto point = [&] {
    const std::int64_t x = coordinate(random), y = coordinate(random), z = coordinate(random);
    return Point{x, y, z};
  };
  const auto minus = [](const Point& a, const Point& b) {
    return Point{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  };
  const auto as_vector = [](const Point& p) {
    return Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]),
                    static_cast<double>(p[2]));
  };
  int hits = 0, misses = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Point corners[] = {point(), point(), point()}, origin = point(), direction = point();
    const Point a = minus(corners[0], origin), b = minus(corners[1], origin),
                c = minus(corners[2], origin);
    const std::int64_t u = volume(direction, b, c), v = volume(direction, c, a),
                       w = volume(direction, a, b);
    if (u == 0 || v == 0 || w == 0) continue;
    const Triangles triangle(
        Mesh{{as_vector(corners[0]), as_vector(corners[1]), as_vector(corners[2])}, {{0, 1, 2}}});
    const SingleRay met =
        cast(triangle, ray(as_vector(origin).cast<float>(), as_vector(direction).cast<float>()));
    const bool is_through = (u > 0) == (v > 0) && (v > 0) == (w > 0);
    const double distance =
        is_through ? static_cast<double>(volume(a, b, c)) / static_cast<double>(u + v + w) : -1.0;
    if (is_through && distance == 0.0) continue;  // starts in the plane of the triangle
    ASSERT_EQ(met.distance >= 0.0F, is_through && distance > 0.0);
    if (met.distance < 0.0F) {
      ++misses;
      continue;
    }
    ++hits;
    const double length = as_vector(direction).norm();
    const double cosine = std::abs(as_vector(direction).dot(
                              Vector3d(met.normal[0], met.normal[1], met.normal[2]).normalized())) /
                          length;
    EXPECT_NEAR(met.distance * length, distance * length, 1e-5 / std::max(cosine, 1e-3));
  }
  EXPECT_GT(hits, 2'000);
  EXPECT_GT(misses, 20'000);
}

/// Returns triangles around a hub that are not coplanar, but flat enough to surround it for all
/// rays from above. Some are very thin.
Mesh random_fan(std::mt19937_64& random, int sides) {
  Mesh mesh{{random_point(random, 1.0F).cast<double>()}, {}};
  std::uniform_real_distribution<double> rise(-0.03, 0.03), radius(0.3, 2.0), chance(0.0, 1.0);
  const auto add_spoke = [&](double angle) {
    const double length = radius(random);
    mesh.vertices.emplace_back(mesh.vertices[0] + Vector3d(length * std::cos(angle),
                                                           length * std::sin(angle), rise(random)));
  };
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    add_spoke(angle);
    if (chance(random) < 0.3) add_spoke(angle + 1e-6);
  }
  for (Vector3d& vertex : mesh.vertices) vertex = vertex.cast<float>().cast<double>();
  const auto spokes = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (std::uint32_t i = 0; i < spokes; ++i) {
    mesh.triangles.push_back({0, i + 1, (i + 1) % spokes + 1});
  }
  return mesh;
}

// A closed ring of triangles around a vertex has no gap, for any rounding of the rays.
TEST(RayKernels, HaveNoGapAtHubOfFan) {
  std::mt19937_64 random(4);
  std::uniform_int_distribution<int> sides(3, 12);
  std::uniform_real_distribution<float> along(0.0F, 1.0F);
  for (int i = 0; i < 2000; ++i) {
    const Mesh mesh = random_fan(random, sides(random));
    const Triangles fan(mesh);
    const Vector3f hub = mesh.vertices[0].cast<float>();
    for (int j = 0; j < 10; ++j) {
      const Vector3f from = hub + Vector3f(0, 0, 6) + random_point(random, 3.0F);
      EXPECT_GE(cast(fan, ray(from, hub - from)).distance, 0.0F);
      const Vector3f aside = hub + 1e-7F * random_point(random, 1.0F);
      EXPECT_GE(cast(fan, ray(from, aside - from)).distance, 0.0F);
      // Close to the hub along a spoke, there are triangles on both sides.
      const Vector3f rim = mesh.vertices[1 + j % (mesh.vertices.size() - 1)].cast<float>();
      const Vector3f on_spoke = hub + 0.1F * along(random) * (rim - hub);
      EXPECT_GE(cast(fan, ray(from, on_spoke - from)).distance, 0.0F);
    }
  }
}

// A rough sheet far from the origin, where coordinates are coarse, is completely visible. All rays
// at its vertices and at points on its edges and diagonals hit it.
TEST(RayKernels, HaveNoGapInRoughSheet) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> height(-0.01, 0.01);
  std::uniform_real_distribution<float> along(0.0F, 1.0F);
  constexpr std::uint32_t cells = 40;
  Mesh sheet;
  for (std::uint32_t row = 0; row <= cells; ++row) {
    for (std::uint32_t column = 0; column <= cells; ++column) {
      const Vector3d vertex(700.0 + 0.1 * column, -300.0 + 0.1 * row, 50.0 + height(random));
      sheet.vertices.emplace_back(vertex.cast<float>().cast<double>());
    }
  }
  for (std::uint32_t row = 0; row < cells; ++row) {
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t a = row * (cells + 1) + column, b = a + cells + 1;
      sheet.triangles.push_back({a, a + 1, b + 1});
      sheet.triangles.push_back({a, b + 1, b});
    }
  }
  const Triangles triangles(sheet);
  const auto is_on_border = [](std::uint32_t vertex) {
    const std::uint32_t row = vertex / (cells + 1), column = vertex % (cells + 1);
    return row == 0 || row == cells || column == 0 || column == cells;
  };
  for (const Vector3f& from : {Vector3f(702, -298, 60), Vector3f(705, -295, 53),
                               Vector3f(0, 0, 300), Vector3f(702, -298, 40)}) {
    for (const auto& [a, b, c] : sheet.triangles) {
      if (is_on_border(a) || is_on_border(b) || is_on_border(c)) continue;
      const Vector3f p = sheet.vertices[a].cast<float>(), q = sheet.vertices[b].cast<float>(),
                     r = sheet.vertices[c].cast<float>();
      for (const Vector3f& target :
           {p, Vector3f(p + along(random) * (q - p)), Vector3f(q + along(random) * (r - q)),
            Vector3f(0.5F * (r + p))}) {
        ASSERT_GE(cast(triangles, ray(from, target - from)).distance, 0.0F)
            << from.transpose() << " to " << target.transpose();
      }
    }
  }
}

// Two coplanar squares. The ray hits the triangle with the smaller index.
TEST(RayKernels, ReturnSmallestIndexOfEquallyNearTriangles) {
  Mesh mesh = square({0, 0, 3}, {0, 0, 1}, 2.0);
  geometry::append(mesh, square({0.5, 0.5, 3}, {0, 0, 1}, 2.0));
  const Triangles triangles(mesh);
  std::mt19937_64 random(6);
  std::uniform_real_distribution<float> slope(-0.1F, 0.3F);
  for (int i = 0; i < 1000; ++i) {
    const SingleRay met = cast(triangles, ray({0, 0, 0}, {slope(random), slope(random), 1.0F}));
    EXPECT_EQ(met.distance, 3.0F);
    EXPECT_LT(met.triangle, 2U);
  }
}

TEST(RayTree, RejectsCoordinatesBeyondSinglePrecision) {
  try {
    const Triangles triangles(Mesh{{{0, 0, 0}, {1e39, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_geometry);
    EXPECT_THAT(error.what(), testing::HasSubstr("triangle 0 has a coordinate"));
  }
}

}  // namespace
}  // namespace skycap::sim
