#include <limits>

#include <skycap/geometry/error.h>
#include <skycap/geometry/usable_scan.h>

#include "example.h"

// Scans with non-finite points are rejected. Without these points the scan is accepted.
const Example usable_scan_example("geometry/usable_scan", [] {
  const float none = std::numeric_limits<float>::quiet_NaN();
  skycap::geometry::Scan scan;
  scan.points = {{4, 0, 0}, {none, none, none}};  // some drivers mark no-return rays this way
  try {
    skycap::geometry::require_usable(scan, {.width = 640, .height = 480});
  } catch (const skycap::Error&) {
    scan.points.pop_back();
  }
  skycap::geometry::require_usable(scan, {.width = 640, .height = 480});
  return scan.points.size() == 1;
});
