/// Small targets for tests of photo planning.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "geometry/pose/photo_camera.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::survey::photo {

/// Returns the camera of a Mavic 3E.
inline geometry::PhotoCameraConfig test_camera() {
  return {.name = "test camera",
          .focal_length = 12.29e-3,
          .sensor_size = {17.3e-3, 13e-3},
          .width = 5280,
          .height = 3956};
}

/// Adds a box to a mesh.
inline void add_box(geometry::Mesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  constexpr std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& face : faces) {
    mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
    mesh.triangles.push_back({first + face[0], first + face[2], first + face[3]});
  }
}

/// Returns a vertical wall in the plane y = 0, visible from the south: x from 0 to `width`, z from
/// `low`.
inline geometry::Mesh wall(double width, double low, double height) {
  geometry::Mesh mesh;
  mesh.vertices = {{0, 0, low}, {width, 0, low}, {width, 0, low + height}, {0, 0, low + height}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace skycap::survey::photo
