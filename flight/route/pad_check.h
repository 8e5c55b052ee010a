/// Whether a vehicle can climb from its pad, and land on rally points.
#pragma once

#include "flight/route/route.h"

namespace skycap::flight {

/// Throws Error{bad_config}, saying what is in the way, unless the climb from options.takeoff keeps
/// the clearance: in `space`, in which the ground is an obstacle, from as high above the pad as
/// that lets it, and in `pad_space`, without the ground, from the pad on; that may be null, and
/// then the rest is not checked. The columns over the rally points of options.returns keep it
/// likewise. Where the ground is known (options.grounds), it is fit to stand on.
void check_pad(const FreeSpace& space, const FreeSpace* pad_space, const RouteOptions& options);

}  // namespace skycap::flight
