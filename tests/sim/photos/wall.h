/// A wall and a small camera for the tests of simulated photos.
#pragma once

#include "geometry/pose/photo_camera.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::sim {

/// A wall of 40 x 40 m in the plane y = `distance`, facing the origin.
inline geometry::Mesh wall_at(double distance) {
  geometry::Mesh mesh;
  mesh.vertices = {
      {-20, distance, -20}, {20, distance, -20}, {20, distance, 20}, {-20, distance, 20}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// 80 x 60 px, field of view 60 degrees across.
inline geometry::PhotoCameraConfig small_camera(int scale = 1) {
  geometry::PhotoCameraConfig camera;
  camera.name = "small";
  camera.focal_length = 0.00692820323;
  camera.sensor_size = {0.008, 0.006};
  camera.width = 80 * scale;
  camera.height = 60 * scale;
  return camera;
}

}  // namespace skycap::sim
