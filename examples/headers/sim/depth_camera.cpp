#include <algorithm>
#include <cmath>

#include <skycap/sim/depth_camera.h>

#include "example.h"

// Simulates a wall that fills the image: each pixel returns a point on the wall.
const Example depth_camera_example("sim/depth_camera", [] {
  const skycap::geometry::Mesh wall{{{-50, 5, -50}, {50, 5, -50}, {0, 5, 80}}, {{0, 1, 2}}};
  const skycap::sim::Scene scene(wall);
  skycap::sim::DepthCameraConfig config = skycap::sim::d435();
  config.noise.sigma = 0.0;
  const auto view = skycap::geometry::look_at({0, 0, 0}, {0, 5, 0});
  const auto scan = skycap::sim::DepthCamera(config).scan(scene, view, 0);
  return scan.points.size() == 848U * 480U &&
         std::ranges::all_of(scan.points, [](const auto& p) { return std::abs(p.y() - 5) < 1e-5; });
});
