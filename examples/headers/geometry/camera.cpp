#include <skycap/geometry/camera.h>

#include "example.h"

// A pixel, the points on its ray, and back; what is behind the camera has no pixel.
const Example camera_example("geometry/camera", [] {
  const skycap::geometry::Camera camera({.width = 640, .height = 480});
  const Eigen::Vector2d pixel(100.0, 50.0);
  const Eigen::Vector3d point = 7.0 * camera.ray(pixel);  // 7 m in front of the image plane
  return camera.project(point)->isApprox(pixel, 1e-12) && !camera.project(-point);
});
