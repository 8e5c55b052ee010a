/// Wall and small camera for the tests of simulated photos.
#pragma once

#include "geometry/pose/photo_camera.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::sim {

/// Returns a wall of 40 x 40 m in the plane y = `distance` that faces the origin.
inline geometry::Mesh wall_at(double distance) {
  geometry::Mesh mesh;
  mesh.vertices = {
      {-20, distance, -20}, {20, distance, -20}, {20, distance, 20}, {-20, distance, 20}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Returns a camera with 80 x 60 px and a horizontal field of view of 60 degrees.
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
