#include <skycap/geometry/cloud_io.h>

#include "example.h"

// Writes three points with their scan indices to a file and reads them back.
const Example cloud_io_example("geometry/cloud_io", [] {
  skycap::geometry::AttributedCloud cloud;
  cloud.positions = {{0, 0, 0}, {1.5F, 0, 0}, {0, 2.5F, 0}};
  cloud.views = {0, 0, 1};
  skycap::geometry::write_cloud(scratch("cloud.ply"), make_columns(cloud));
  const auto read = skycap::geometry::read_cloud(scratch("cloud.ply"));
  return read.positions == cloud.positions && read.views == cloud.views;
});
