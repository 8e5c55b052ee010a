#include <skycap/sim/depth_camera.h>
#include <skycap/sim/models.h>
#include <skycap/survey/see.h>

#include "example.h"

// Passes a first scan to SEE++ and gets the next view.
const Example see_example("survey/see", [] {
  const skycap::sim::Scene scene(skycap::sim::builtin_model("teapot"));
  const skycap::sim::DepthCamera camera(skycap::sim::d435());
  skycap::survey::see::SeePlanner planner({}, camera.camera());  // SEE++ as published
  const auto scan = camera.scan(scene, skycap::geometry::look_at({6, 0, 3}, {0, 0, 1}), 0);
  const auto view = planner.next_view(scan);
  return view && planner.cloud().size() > 0 && planner.view_distance() > 0.0;
});
