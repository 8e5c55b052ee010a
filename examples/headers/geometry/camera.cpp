#include <skycap/geometry/camera.h>

#include "example.h"

// Converts a pixel to a point on its ray and back. Points behind the camera have no pixel.
const Example camera_example("geometry/camera", [] {
  const skycap::geometry::Camera camera({.width = 640, .height = 480});
  const Eigen::Vector2d pixel(100.0, 50.0);
  const Eigen::Vector3d point = 7.0 * camera.ray(pixel);  // depth of 7 m
  return camera.project(point)->isApprox(pixel, 1e-12) && !camera.project(-point);
});
