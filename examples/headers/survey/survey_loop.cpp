#include <skycap/sim/depth_camera.h>
#include <skycap/sim/models.h>
#include <skycap/survey/surfel_planner.h>
#include <skycap/survey/survey_loop.h>

#include "example.h"

// Runs a planner and a sensor alternately until four views have been taken.
const Example survey_loop_example("survey/survey_loop", [] {
  const skycap::sim::Scene scene(skycap::sim::builtin_model("teapot"));
  const skycap::sim::DepthCamera camera(skycap::sim::d435());
  skycap::survey::surfel::SurfelPlanner planner({.coverage_radius = 0.05}, camera.camera());
  std::uint64_t frame = 0;
  const auto sense = [&](const skycap::geometry::View& view, skycap::geometry::Scan) {
    return camera.scan(scene, view, frame++);
  };
  const auto survey = run_survey(planner, skycap::geometry::look_at({6, 0, 3}, {0, 0, 1}),
                                 {.max_views = 4}, {.sense = sense});
  return survey.views.size() == 4 && to_string(survey.stop_reason) == std::string("view_limit");
});
