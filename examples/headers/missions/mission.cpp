#include <skycap/missions/mission.h>

#include "example.h"

// Creates a mission from text and overrides one of its keys.
const Example mission_example("missions/mission", [] {
  const auto mission = skycap::missions::library::Mission::parse(
      "scene: {model: builtin:teapot}\nevaluation: {coverage_distance: 0.005}\nseed: 7\n",
      "teapot.yaml", {{"planner.name", "skycap"}});
  return mission.seed() == 7 && mission.camera().width == 848 &&
         mission.planner()->cloud().size() == 0 && !mission.model().triangles.empty();
});
