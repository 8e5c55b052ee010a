/// Procedural mesh of any size for benchmarks: a hilly sphere of radius 20 m.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::benchmarks {

/// Returns the height [m] above the sphere in the direction `n`: seven octaves of waves, each with
/// half the amplitude of the previous one.
inline double hill(const Eigen::Vector3d& n) {
  double height = 0.0, size = 1.0;
  Eigen::Vector3d p = 3.0 * n;
  for (int octave = 0; octave < 7; ++octave, size *= 0.5, p = 2.03 * p.array() + 1.7) {
    height += size * std::sin(p.x() + 2.0 * std::sin(p.y())) * std::cos(p.z() + std::sin(p.x()));
  }
  return height;
}

/// Returns a mesh of about `triangles` triangles: the six grids of a cube, projected to a sphere.
inline geometry::Mesh planet(std::size_t triangles) {
  const auto cells =
      static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 12.0)));
  geometry::Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const double side = face % 2 == 0 ? 1.0 : -1.0;
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t row = 0; row <= cells; ++row) {
      for (std::uint32_t column = 0; column <= cells; ++column) {
        Eigen::Vector3d corner;
        corner[axis] = side;
        corner[(axis + 1) % 3] = std::tan((2.0 * row / cells - 1.0) * 0.785398163397448);
        corner[(axis + 2) % 3] = side * std::tan((2.0 * column / cells - 1.0) * 0.785398163397448);
        const Eigen::Vector3d direction = corner.normalized();
        mesh.vertices.emplace_back((20.0 + hill(direction)) * direction);
      }
    }
    for (std::uint32_t row = 0; row < cells; ++row) {
      for (std::uint32_t column = 0; column < cells; ++column) {
        const std::uint32_t a = base + row * (cells + 1) + column, b = a + cells + 1;
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
      }
    }
  }
  return mesh;
}

}  // namespace skycap::benchmarks
