/// What depth cameras return where nothing is.
///
/// At the edge of a near surface a pixel sees this one and the one behind, and many a camera
/// returns a depth between the two: a flying pixel. It is told by its neighbours on opposite sides
/// (along rows, columns and diagonals, one or two pixels away): one is much nearer, the other much
/// farther, as on a surface that the line of sight meets at less than ten degrees, and by 3 % of
/// the depth; but unlike on such a surface, beyond them depth goes on evenly. An isolated return
/// has fewer than three others among the 24 pixels around it that a surface at more than ten
/// degrees would put there.
#pragma once

#include <cstddef>

#include "geometry/place/camera.h"
#include "geometry/points/scan.h"

namespace skycap::missions::online {

struct LeftOut {
  std::size_t flying = 0, isolated = 0;
};

/// Takes flying pixels and isolated returns out of an organised scan of that camera; the rest stays
/// as it is. A scan without pixels stays whole.
LeftOut remove_flying_pixels(geometry::Scan& scan, const geometry::Camera& camera);

}  // namespace skycap::missions::online
