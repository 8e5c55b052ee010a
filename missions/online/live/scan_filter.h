/// Removal of depth camera artefacts.
///
/// At the edge of a near surface, a pixel covers this surface and the one behind it, and many
/// cameras return a depth between the two: a flying pixel. It is detected by its neighbours on
/// opposite sides (along rows, columns and diagonals, one or two pixels away). One is much nearer
/// and the other much farther: by 3% of the depth and by more than on a surface at ten degrees to
/// the line of sight. Unlike on such a surface, the depth varies smoothly beyond these neighbours.
/// An isolated return has fewer than three neighbours among the 24 surrounding pixels that a
/// surface at more than ten degrees could explain.
#pragma once

#include <cstddef>

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"

namespace skycap::missions::online {

struct LeftOut {
  std::size_t flying = 0, isolated = 0;
};

/// Removes flying pixels and isolated returns from an organised scan of `camera`. Other points and
/// scans without pixels remain unchanged.
LeftOut remove_flying_pixels(geometry::Scan& scan, const geometry::Camera& camera);

}  // namespace skycap::missions::online
