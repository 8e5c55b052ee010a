#include <algorithm>

#include <skycap/sim/models.h>

#include "example.h"

// Lists the built-in scenes, and creates one that is 40 m high.
const Example models_example("sim/models", [] {
  const auto names = skycap::sim::builtin_models();
  const auto coarse = skycap::sim::builtin_model(
      "radcliffe-camera", {.detail = skycap::sim::LevelOfDetail::coarse, .has_ground = false});
  const double height = skycap::geometry::bounding_box(coarse).sizes().z();
  return std::ranges::find(names, "teapot") != names.end() && height > 35.0 && height < 50.0;
});
