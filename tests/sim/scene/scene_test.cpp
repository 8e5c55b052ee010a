#include "sim/scene/scene.h"

#include <array>
#include <fstream>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/error.h"
#include "tests/sim/packets.h"
#include "tests/sim/shapes.h"
#include "tests/support/complaint.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vector3d{normal(random), normal(random), normal(random)}.normalized();
}

TEST(Scene, HitsNearerFaceOfCube) {
  const Scene scene(cube({1, 2, 3}, 2.0), 1);
  const auto hit = scene.first_hit({-5, 2.3, 3.1}, {1, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 5.0, 1e-6);
  EXPECT_TRUE(hit->normal.isApprox(-Vector3d::UnitX(), 1e-6)) << hit->normal.transpose();
  EXPECT_THAT(hit->triangle, testing::AnyOf(8U, 9U));  // the triangles at x = 0
  EXPECT_FALSE(scene.first_hit({-5, 2.3, 3.1}, {-1, 0, 0}));
}

// The distance and its limit are in multiples of the direction's length.
TEST(Scene, MeasuresDistanceInLengthsOfDirection) {
  const Scene scene(cube({0, 0, 0}, 2.0), 1);
  for (const double length : {1e-6, 0.5, 3.0, 1e6}) {
    const auto hit = scene.first_hit({-5, 0.1, 0.2}, {length, 0, 0});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance * length, 4.0, 1e-6);
    EXPECT_FALSE(scene.first_hit({-5, 0.1, 0.2}, {length, 0, 0}, 3.99 / length));
    EXPECT_TRUE(scene.first_hit({-5, 0.1, 0.2}, {length, 0, 0}, 4.01 / length));
  }
}

// Closed form: t = -b - sqrt(b^2 - c). Chords are inside the sphere. A ray from outside therefore
// travels further by at most the sagitta over the cosine of the incidence.
TEST(Scene, MatchesClosedFormRangesToSphere) {
  const Vector3d centre(3, -2, 1);
  const double radius = 2.0;
  const int splits = 6;
  const Scene scene(sphere(centre, radius, splits), 1);
  // The longest edge is near the centre of a face, 1.73 times the 90 degrees / 2^splits at the
  // equator.
  const double edge_angle = 1.75 * 0.5 * std::numbers::pi / (1 << splits);
  const double sagitta = radius * (1.0 - std::cos(edge_angle / std::sqrt(3.0)));
  std::mt19937_64 random(1);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d origin = centre + 7.0 * random_direction(random);
    const Vector3d direction = (centre + 1.9 * random_direction(random) - origin).normalized();
    const double b = direction.dot(origin - centre);
    const double c = (origin - centre).squaredNorm() - radius * radius;
    const double distance = -b - std::sqrt(b * b - c);
    const double cosine = -direction.dot(origin + distance * direction - centre) / radius;
    if (cosine < 0.3) continue;  // the bound below is invalid near the silhouette
    const auto hit = scene.first_hit(origin, direction);
    ASSERT_TRUE(hit);
    EXPECT_GT(hit->distance, distance - 1e-5);  // single precision at 10 m
    EXPECT_LT(hit->distance, distance + 1.1 * sagitta / cosine + 1e-5);
    ++hits;
  }
  EXPECT_GT(hits, 1500);
}

TEST(Scene, DetectsBlockedSegments) {
  const Scene scene(cube({0, 0, 0}, 2.0), 1);
  EXPECT_TRUE(scene.is_blocked({-5, 0, 0}, {5, 0, 0}));
  EXPECT_TRUE(scene.is_blocked({-5, 0, 0}, {0, 0, 0}));
  EXPECT_FALSE(scene.is_blocked({-5, 0, 0}, {-1.001, 0, 0}));
  EXPECT_FALSE(scene.is_blocked({-5, 0, 0}, {-5, 5, 5}));
  EXPECT_FALSE(scene.is_blocked({-5, 0, 0}, {-5, 0, 0}));
}

// A square hole of 0.2 m in a wall: exactly the rays through the hole reach the wall behind.
TEST(Scene, PassesOnlyRaysInsideHole) {
  geometry::Mesh mesh;
  for (const auto& [y, z] : {std::pair{-1.1, 0.0}, {1.1, 0.0}, {0.0, -1.1}, {0.0, 1.1}}) {
    geometry::append(mesh, square({5, y, z}, {-1, 0, 0}, 2.0));
  }
  geometry::append(mesh, square({8, 0, 0}, {-1, 0, 0}, 20.0));
  const Scene scene(mesh, 1);
  for (int row = -20; row <= 20; ++row) {
    for (int column = -20; column <= 20; ++column) {
      const double y = 0.0101 * column, z = 0.0103 * row;  // no ray hits the rim
      const auto hit = scene.first_hit({0, 0, 0}, Vector3d(5, y, z));
      ASSERT_TRUE(hit);
      const bool is_open = std::abs(y) < 0.1 && std::abs(z) < 0.1;
      EXPECT_NEAR(hit->distance, is_open ? 1.6 : 1.0, 1e-6) << y << ", " << z;
    }
  }
}

// Checks that each ray hits something within `reach` times the distance to its target, alone and in
// packets.
void expect_no_leaks(const Scene& scene, const Vector3d& origin,
                     const std::vector<Vector3d>& targets) {
  constexpr float reach = 1.0F + 1e-4F;
  int leaks = 0, packet_leaks = 0;
  for (const Vector3d& target : targets) {
    const auto hit = scene.first_hit(origin, target - origin);
    leaks += hit && hit->distance < reach ? 0 : 1;
  }
  RayPacket packet;
  for (std::size_t first = 0; first < targets.size(); first += RayPacket::width) {
    for (int lane = 0; lane < RayPacket::width; ++lane) {
      const Vector3d& target = targets[std::min(first + lane, targets.size() - 1)];
      aim(packet, lane, scene, origin, target - origin);
    }
    ray_kernels().cast_tile_distances(scene.trees().target, &packet, 1, reach);
    for (const float distance : packet.distance) packet_leaks += distance < 0.0F ? 1 : 0;
  }
  EXPECT_EQ(leaks, 0) << "single rays";
  EXPECT_EQ(packet_leaks, 0) << "packets";
}

// Each ray at a vertex or edge point of a closed surface must hit it there or before, from inside
// and from outside.
TEST(Scene, HasNoLeaksAtVerticesAndEdges) {
  const geometry::Mesh mesh = sphere({4, 5, 6}, 3.0, 5);
  const Scene scene(mesh, 1);
  std::vector<Vector3d> targets = mesh.vertices;
  for (const auto& [a, b, c] : mesh.triangles) {
    for (const double along : {0.5, 0.25, 0.1234}) {
      targets.push_back(mesh.vertices[a] + along * (mesh.vertices[b] - mesh.vertices[a]));
      targets.push_back(mesh.vertices[b] + along * (mesh.vertices[c] - mesh.vertices[b]));
    }
  }
  for (const Vector3d& inside : {Vector3d(4, 5, 6), Vector3d(4.3, 5.2, 5.1), Vector3d(2, 4, 7)}) {
    expect_no_leaks(scene, inside, targets);
  }
  for (const Vector3d& outside : {Vector3d(9, 5, 6), Vector3d(-3, 20, 31)}) {
    // Targets on the far side are hidden. Rays next to the silhouette may miss because of rounding.
    std::vector<Vector3d> facing;
    std::copy_if(
        targets.begin(), targets.end(), std::back_inserter(facing), [&](const Vector3d& t) {
          return (outside - t).normalized().dot((t - Vector3d(4, 5, 6)).normalized()) > 0.1;
        });
    ASSERT_GT(facing.size(), 8'000U);
    expect_no_leaks(scene, outside, facing);
  }
}

// A scene in UTM coordinates, where single precision has steps of 0.5 m.
TEST(Scene, KeepsRangesFarFromOrigin) {
  const Vector3d far(474'500.0, 5'474'500.0, 120.0);
  const Scene here(sphere({0, 0, 0}, 20.0, 4), 1), there(sphere(far, 20.0, 4), 1);
  std::mt19937_64 random(3);
  for (int i = 0; i < 500; ++i) {
    const Vector3d origin = 60.0 * random_direction(random);
    const Vector3d direction = (15.0 * random_direction(random) - origin).normalized();
    const auto hit_here = here.first_hit(origin, direction);
    const auto hit_there = there.first_hit(origin + far, direction);
    ASSERT_TRUE(hit_here && hit_there);
    EXPECT_NEAR(hit_there->distance, hit_here->distance, 1e-4);
  }
}

Eigen::Isometry3d make_pose(const Vector3d& position, double heading) {
  return Eigen::Translation3d(position) * Eigen::AngleAxisd(heading, Vector3d::UnitZ());
}

/// Three spheres and a cube below them, as copies and as one mesh.
struct Copies {
  geometry::Mesh ball = sphere({0.5, 0, 2}, 1.5, 4), base = cube({0, 0, -1}, 2.0);
  std::vector<Eigen::Isometry3d> poses = {make_pose({0, 0, 0}, 0.3), make_pose({20, -7, 1}, 2.0),
                                          make_pose({-9, 11, 0.5}, -1.0)};
  std::vector<float> base_reflectances = std::vector<float>(base.triangles.size(), 0.9F);

  Scene scene() const {
    return Scene(std::array{ScenePart{ball, {}, poses}, ScenePart{base, base_reflectances, {}}}, 1);
  }
  geometry::Mesh flattened() const {
    geometry::Mesh all;
    for (const Eigen::Isometry3d& world_from_ball : poses) {
      geometry::Mesh moved = ball;
      geometry::transform(moved, Eigen::Affine3d(world_from_ball));
      geometry::append(all, moved);
    }
    geometry::append(all, base);
    return all;
  }
};

// Reference: the same surfaces in a single mesh. Single precision at 40 m has an error of 4e-6 m,
// and more for grazing rays. At edges either triangle may be hit.
TEST(Scene, MatchesSingleMeshForCopies) {
  const Copies copies;
  const geometry::Mesh mesh = copies.flattened();
  const Scene scene = copies.scene(), reference(mesh, 1);
  std::mt19937_64 random(5);
  std::uniform_int_distribution<std::size_t> any(0, mesh.vertices.size() - 1);
  int hits = 0, other_triangles = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d origin = 30.0 * random_direction(random);
    const Vector3d target = mesh.vertices[any(random)] + 0.3 * random_direction(random);
    const auto hit = scene.first_hit(origin, target - origin);
    const auto expected = reference.first_hit(origin, target - origin);
    if (expected.has_value() != hit.has_value()) {
      ++other_triangles;  // near a silhouette
      continue;
    }
    if (!hit) continue;
    ++hits;
    if (hit->triangle != expected->triangle) {
      ++other_triangles;
      continue;
    }
    const double cosine = std::abs(hit->normal.dot((target - origin).normalized()));
    EXPECT_NEAR(hit->distance, expected->distance, 1e-6 / std::max(cosine, 0.01));
    EXPECT_TRUE(hit->normal.isApprox(expected->normal, 1e-4));
    EXPECT_EQ(scene.reflectance(hit->triangle),
              hit->triangle < 3 * copies.ball.triangles.size() ? Scene::default_reflectance : 0.9F);
    EXPECT_EQ(scene.is_blocked(origin, target), reference.is_blocked(origin, target));
  }
  EXPECT_GT(hits, 3000);
  EXPECT_LT(other_triangles, 10);
}

TEST(Scene, MatchesSingleSightLinesInBatches) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Scene scene(sphere({0, 0, 0}, 1.0, 3));
  std::size_t blocked = 0;
  for (int round = 0; round < 500; ++round) {
    const std::size_t count = round % (Scene::max_sight_lines + 1);
    std::vector<Scene::SightLine> sight_lines;
    const Vector3d far = 20.0 * random_direction(random);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3d near = 1.2 * Vector3d{uniform(random), uniform(random), uniform(random)};
      // Parallel lines of equal length, converging lines, and lines of zero length.
      sight_lines.push_back({i % 5 == 4 ? near : i % 2 == 0 ? near + far : far, near});
    }
    const std::uint32_t answer = scene.blocked(sight_lines);
    EXPECT_EQ(answer >> count, 0U);
    for (std::size_t i = 0; i < count; ++i) {
      const bool expected = scene.is_blocked(sight_lines[i].from, sight_lines[i].to);
      EXPECT_EQ((answer >> i & 1U) != 0, expected) << round << ", " << i;
      blocked += expected;
    }
  }
  EXPECT_GT(blocked, 500U);
  EXPECT_LT(blocked, 3500U);
}

TEST(Scene, HasNoLeaksAtVerticesAndEdgesOfCopies) {
  const Copies copies;
  const Scene scene = copies.scene();
  for (const Eigen::Isometry3d& world_from_ball : copies.poses) {
    std::vector<Vector3d> targets;
    for (const auto& [a, b, c] : copies.ball.triangles) {
      const Vector3d& from = copies.ball.vertices[a];
      targets.push_back(world_from_ball * from);
      for (const double along : {0.5, 0.1234}) {
        targets.push_back(world_from_ball * (from + along * (copies.ball.vertices[b] - from)));
      }
    }
    expect_no_leaks(scene, world_from_ball * Vector3d(0.5, 0, 2), targets);
    expect_no_leaks(scene, world_from_ball * Vector3d(0.9, -0.4, 2.7), targets);
  }
}

// 131,072 triangles take about 10 MB. Two hundred copies would take 2 GB.
TEST(Scene, SharesMemoryAmongCopies) {
  const auto resident_bytes = [] {
    std::size_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  };
  const geometry::Mesh ball = sphere({0, 0, 0}, 1.0, 7);
  ASSERT_EQ(ball.triangles.size(), 131'072U);
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(200);
  for (int i = 0; i < 200; ++i) poses.push_back(make_pose({3.0 * i, 0, 0}, 0.1 * i));
  const std::size_t before = resident_bytes();
  const Scene scene(std::array{ScenePart{ball, {}, poses}}, 1);
  EXPECT_LT(resident_bytes() - before, 100'000'000U);
  const auto hit = scene.first_hit({3.0 * 150, -10, 0}, {0, 1, 0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 9.0, 1e-3);
  EXPECT_EQ(hit->triangle / ball.triangles.size(), 150U);
}

TEST(Scene, RejectsEmptyPartList) {
  EXPECT_THAT(testing_support::thrown_message([&] { Scene(std::span<const ScenePart>(), 1); }),
              testing::HasSubstr("the scene has no meshes"));
}

TEST(Scene, RejectsMeshWithoutSurface) {
  EXPECT_THAT(testing_support::thrown_message([&] { Scene(geometry::Mesh{}, 1); }),
              testing::HasSubstr("the mesh contains no triangle with a positive area"));
}

}  // namespace
}  // namespace skycap::sim
