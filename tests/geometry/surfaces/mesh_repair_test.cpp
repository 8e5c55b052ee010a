#include "geometry/surfaces/mesh_repair.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

/// Returns an octahedron of radius 1 around `centre`, oriented outward.
Mesh octahedron(const Vector3d& centre) {
  Mesh mesh{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (Vector3d& vertex : mesh.vertices) vertex += centre;
  return mesh;
}

double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6.0;
  }
  return sum;
}

constexpr double octahedron_volume = 4.0 / 3.0;

TEST(MeshRepair, MergesEqualVerticesAndRemovesUnusedOnes) {
  Mesh mesh{{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-0.0, 1, 0}, {1, 1, 0}},
            {{1, 2, 3}, {4, 6, 5}}};
  weld_vertices(mesh);
  EXPECT_THAT(mesh.vertices, testing::ElementsAre(Vector3d(0, 0, 0), Vector3d(1, 0, 0),
                                                  Vector3d(0, 1, 0), Vector3d(1, 1, 0)));
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{1, 3, 2}));
}

TEST(MeshRepair, RemovesOnlyTrianglesWithoutArea) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1e-12, 0}}, {{0, 1, 1}, {0, 1, 2}, {0, 2, 3}}};
  drop_degenerate_triangles(mesh);
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.triangles[0][2], 3U);
}

// Random flips of triangles in separate closed bodies are corrected.
TEST(MeshRepair, OrientsRandomlyFlippedSolidsOutward) {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 20; ++trial) {
    Mesh mesh = octahedron({0, 0, 0});
    append(mesh, octahedron({100, -50, 3}));
    const Mesh original = mesh;
    for (auto& triangle : mesh.triangles) {
      if (random() % 2 == 0) std::swap(triangle[0], triangle[1]);
    }
    orient_outward(mesh);
    EXPECT_NEAR(volume(mesh), 2.0 * octahedron_volume, 1e-9);
  }
}

TEST(MeshRepair, OrientsOpenShellOutward) {
  Mesh shell = octahedron({5, 5, 5});
  shell.triangles.resize(6);
  Mesh turned = shell;
  for (auto& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
  std::swap(turned.triangles[3][1], turned.triangles[3][2]);
  orient_outward(turned);
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    const auto& [a, b, c] = turned.triangles[t];
    const Vector3d normal =
        (turned.vertices[b] - turned.vertices[a]).cross(turned.vertices[c] - turned.vertices[a]);
    EXPECT_GT(normal.dot(turned.vertices[a] - Vector3d(5, 5, 5)), 0.0) << t;
  }
}

TEST(MeshRepair, SeparatesPartsAtNonManifoldEdges) {
  Mesh fan{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
           {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}};
  const auto before = fan.triangles;
  orient_outward(fan);  // three separate flat parts have no outside, so no triangle is flipped
  EXPECT_EQ(fan.triangles, before);
}

}  // namespace
}  // namespace skycap::geometry
