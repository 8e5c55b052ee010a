#include <skycap/geometry/scan.h>

#include "example.h"

// Passes the points of an existing buffer to a planner.
const Example scan_example("geometry/scan", [] {
  const std::vector<Eigen::Vector3f> buffer{{4, 0, 0}, {4, 1, 0}};  // buffer of a driver
  // Refers to the buffer without a copy.
  skycap::geometry::ScanSpan scan;
  scan.world_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
  scan.points = buffer;
  return scan.points.data() == buffer.data() && scan.sensor_position().z() == 2.0;
});
