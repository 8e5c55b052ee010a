/// Validation of scans from external sources.
#pragma once

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"

namespace skycap::geometry {

/// Throws Error{bad_geometry}, which states the rule, unless a planner can process the scan. Points
/// and sensor position must be finite and close enough to the origin for a single-precision
/// resolution of half a millimetre. Pixels, if present, must be in ascending order, one per point,
/// and inside the image of `camera`. Needs one pass over the points.
void require_usable(const ScanSpan& scan, const CameraConfig& camera);

}  // namespace skycap::geometry
