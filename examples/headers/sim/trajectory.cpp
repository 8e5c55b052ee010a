#include <skycap/sim/trajectory.h>

#include "example.h"

// Interpolates the pose of a platform between two timestamps.
const Example trajectory_example("sim/trajectory", [] {
  const skycap::sim::Trajectory path(
      {{.time = 10.0, .position = {0, 0, 20}}, {.time = 14.0, .position = {8, 0, 20}}});
  return path.pose(11.0).translation().isApprox(Eigen::Vector3d(2, 0, 20), 1e-12) &&
         path.end() - path.start() == 4.0;
});
