/// Procedural town for benchmarks: 240 m of rolling terrain with a hundred blocks of rough walls
/// and roofs, in one seamless mesh. Airborne scanners are compared on such scenes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "geometry/surfaces/mesh.h"

namespace skycap::benchmarks {

/// Returns the height [m] of the town at a position of its 240 m square. The terrain has five
/// octaves of waves. Each cell of 24 m contains a block 8 to 40 m high with sides of 12 to 18 m.
inline double town_height(double x, double y) {
  double ground = 0.0, size = 2.0, u = 0.03 * x, v = 0.03 * y;
  for (int octave = 0; octave < 5; ++octave, size *= 0.5, u = 2.1 * u + 1.7, v = 2.1 * v + 0.9) {
    ground += size * std::sin(u + std::sin(v)) * std::cos(v + std::sin(u));
  }
  const double column = std::floor(x / 24.0), row = std::floor(y / 24.0);
  const double chance = 0.5 + 0.5 * std::sin(12.9898 * column + 78.233 * row);
  const double half_side = 6.0 + 3.0 * chance;
  const bool is_block = std::abs(x - 24.0 * (column + 0.5)) < half_side &&
                        std::abs(y - 24.0 * (row + 0.5)) < half_side;
  const double rough = 0.05 * std::sin(31.0 * x + 17.0 * y) * std::cos(23.0 * y - 11.0 * x);
  return ground + rough + (is_block ? 8.0 + 32.0 * chance : 0.0);
}

/// Returns a mesh of about `triangles` triangles, centred at x = y = 0.
inline geometry::Mesh town(std::size_t triangles) {
  const auto cells =
      static_cast<std::uint32_t>(std::lround(std::sqrt(0.5 * static_cast<double>(triangles))));
  geometry::Mesh mesh;
  for (std::uint32_t row = 0; row <= cells; ++row) {
    for (std::uint32_t column = 0; column <= cells; ++column) {
      const double x = 240.0 * column / cells - 120.0, y = 240.0 * row / cells - 120.0;
      mesh.vertices.emplace_back(x, y, town_height(x, y));
    }
  }
  for (std::uint32_t row = 0; row < cells; ++row) {
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t a = row * (cells + 1) + column, b = a + cells + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

}  // namespace skycap::benchmarks
