#include <skycap/sim/depth_camera.h>
#include <skycap/sim/models.h>
#include <skycap/survey/surfel_planner.h>

#include "example.h"

// Adds three scans and reads the planner's estimate of the surface.
const Example skycap_planner_example("survey/surfel_planner", [] {
  const skycap::sim::Scene scene(skycap::sim::builtin_model("teapot"));
  const skycap::sim::DepthCamera camera(skycap::sim::d435());
  skycap::survey::surfel::SurfelPlanner planner({.coverage_radius = 0.05}, camera.camera());
  auto view = skycap::geometry::look_at({6, 0, 3}, {0, 0, 1});
  const double none = planner.predicted_coverage();
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    view = planner.next_view(camera.scan(scene, view, frame)).value();
  }
  return planner.predicted_coverage() > none && planner.estimate().area > 0.0;
});
