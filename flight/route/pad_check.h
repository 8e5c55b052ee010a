/// Checks of the climb from the pad and of the landing points.
#pragma once

#include "flight/route/route.h"

namespace skycap::flight {

/// Checks the climb from options.takeoff, the rally points and the ground below them. In `space`,
/// where the ground is an obstacle, each column is checked from the height at which the ground
/// allows the clearance. In `pad_space`, without the ground, it is checked from the pad. If
/// `pad_space` is nullptr, that part and the rally points are not checked. Throws Error{bad_config}
/// with the obstacle if the clearance is violated, or if known ground (options.grounds) exceeds its
/// limits.
void check_pad(const FreeSpace& space, const FreeSpace* pad_space, const RouteOptions& options);

}  // namespace skycap::flight
