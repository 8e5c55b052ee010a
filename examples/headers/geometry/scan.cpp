#include <skycap/geometry/scan.h>

#include "example.h"

// Points that lie elsewhere, as planners take them.
const Example scan_example("geometry/scan", [] {
  const std::vector<Eigen::Vector3f> buffer{{4, 0, 0}, {4, 1, 0}};  // of a driver
  skycap::geometry::ScanSpan scan;                                  // which copies nothing
  scan.world_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
  scan.points = buffer;
  return scan.points.data() == buffer.data() && scan.sensor_position().z() == 2.0;
});
