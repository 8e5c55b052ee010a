#include <skycap/missions/laser_scan.h>

#include "example.h"

// Simulates a laser scanner on a flight around a scene, chunk by chunk.
const Example laser_scan_example("missions/laser_scan", [] {
  const auto mission = skycap::missions::library::Mission::parse(
      "scene: {model: builtin:teapot, longest_side: 20}\n"
      "evaluation: {coverage_distance: 0.1}\n"
      "scan: {orbit: {radius: 25, speed: 40}}\n",
      "orbit.yaml");
  skycap::missions::library::LaserScan scan(mission, {.sensor = "velodyne_vlp16"});
  std::size_t returns = 0;
  for (auto chunk = scan.next(); !chunk.empty(); chunk = scan.next()) {
    for (const auto& part : chunk) returns += part.size();
  }
  return returns > 1000;
});
