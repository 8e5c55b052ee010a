#include <cmath>

#include <skycap/sim/lidar.h>

#include "example.h"

// Simulates a rotating laser 10 m above the ground: each pulse returns with the expected range.
const Example lidar_example("sim/lidar", [] {
  const skycap::geometry::Mesh ground{{{-900, -900, 0}, {900, -900, 0}, {0, 900, 0}}, {{0, 1, 2}}};
  const skycap::sim::Scene scene(ground);
  skycap::sim::LidarConfig config;
  config.channels = {{.elevation = -0.5}};  // one laser, 0.5 rad downwards
  const skycap::sim::Lidar lidar(config);
  const skycap::sim::Trajectory still(
      {{.time = 0, .position = {0, 0, 10}}, {.time = 0.1, .position = {0, 0, 10}}});
  const auto returns =
      lidar.measure(scene, {.ground_truth = still, .estimated = still}, {0, lidar.firings(still)});
  const Eigen::Vector3d first = returns.origin + returns.points.front().cast<double>();
  return returns.size() == lidar.firings(still) &&
         std::abs((first - Eigen::Vector3d(0, 0, 10)).norm() - 10 / std::sin(0.5)) < 1e-4;
});
