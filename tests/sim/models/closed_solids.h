/// Common check of solids for the model tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// Returns why the mesh is not a closed, consistently oriented, outward-facing surface. Empty if it
/// is.
inline std::string closedness_error(const geometry::Mesh& mesh) {
  std::vector<std::array<std::uint32_t, 2>> sides, reversed;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices.at(triangle[0]), b = mesh.vertices.at(triangle[1]),
                          c = mesh.vertices.at(triangle[2]);
    if ((b - a).cross(c - a).norm() < 1e-14) return "a triangle has no area";
    for (std::size_t i = 0; i < 3; ++i) {
      sides.push_back({triangle[i], triangle[(i + 1) % 3]});
      reversed.push_back({triangle[(i + 1) % 3], triangle[i]});
    }
  }
  std::sort(sides.begin(), sides.end());
  std::sort(reversed.begin(), reversed.end());
  if (std::adjacent_find(sides.begin(), sides.end()) != sides.end()) {
    return "two triangles go the same way along one edge";
  }
  if (sides != reversed) return "an edge has a triangle on one side only";
  if (!(signed_volume(mesh) > 0.0)) return "it faces inwards";
  return "";
}

}  // namespace skycap::sim::models
