#include <skycap/missions/simulation.h>

#include "example.h"

// Simulates the first scan of a mission's survey, for use in a custom survey loop.
const Example simulation_example("missions/simulation", [] {
  const auto mission = skycap::missions::library::Mission::parse(
      "scene: {model: builtin:teapot}\nevaluation: {coverage_distance: 0.005}\n", "teapot.yaml");
  const skycap::missions::library::Simulation simulation(mission);
  const auto scan = simulation.scan(simulation.first_view(), 0);
  return !scan.points.empty() && mission.planner()->next_view(scan).has_value();
});
