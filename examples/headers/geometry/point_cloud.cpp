#include <algorithm>

#include <skycap/geometry/point_cloud.h>

#include "example.h"

// Counts the points that the second scan added.
const Example point_cloud_example("geometry/point_cloud", [] {
  skycap::geometry::PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  cloud.views = {0, 1, 1};
  return std::ranges::count(cloud.views, 1U) == 2 && cloud.size() == 3;
});
