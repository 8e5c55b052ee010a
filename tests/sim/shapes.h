/// Meshes with closed-form results, for the tests of the simulator.
#pragma once

#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::sim {

/// Returns two triangles that form a square of `size` metres around `centre` with this normal.
inline geometry::Mesh square(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal,
                             double size) {
  const Eigen::Vector3d u = 0.5 * size * geometry::any_orthogonal(normal.normalized());
  const Eigen::Vector3d v = normal.normalized().cross(u);
  return {{centre - u - v, centre + u - v, centre + u + v, centre - u + v}, {{0, 1, 2}, {0, 2, 3}}};
}

/// Returns the closed surface of a cube with edges of `size` metres.
inline geometry::Mesh cube(const Eigen::Vector3d& centre, double size) {
  geometry::Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5,
                               corner & 4 ? 0.5 : -0.5);
    mesh.vertices.emplace_back(centre + size * sign);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Returns a closed sphere with its vertices on the exact sphere: an octahedron whose triangles are
/// split into four `splits` times.
inline geometry::Mesh sphere(const Eigen::Vector3d& centre, double radius, int splits) {
  geometry::Mesh mesh{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int split = 0; split < splits; ++split) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex = centre + radius * vertex;
  return mesh;
}

}  // namespace skycap::sim
