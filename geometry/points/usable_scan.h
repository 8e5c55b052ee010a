/// What is asked of a scan that comes from outside before a planner sees it.
#pragma once

#include "geometry/place/camera.h"
#include "geometry/points/scan.h"

namespace skycap::geometry {

/// Throws Error{bad_geometry}, saying what would be right, unless a planner can take in the scan:
/// points and a sensor that are finite and so near the origin that single precision keeps half a
/// millimetre;
/// pixels, if there are any, one for each point, ascending, of that camera. One pass over memory.
void require_usable(const ScanSpan& scan, const CameraConfig& camera);

}  // namespace skycap::geometry
