/// Alternatives to stop-and-go flight on a verified route: curved legs and fly-through capture.
#pragma once

#include "flight/clearance/clearance.h"
#include "flight/motion/motion.h"
#include "flight/route/leg_costs.h"
#include "flight/route/route.h"

namespace skycap::flight {

/// Adds curves of the style in `route.options` to its legs or sorties. A curve is added only if it
/// is verified and takes no more time or energy than the flight with stops. If the route has
/// returns, every point of the curve must have one, too.
void add_curves(Route& route, const FreeSpace& space, const Motion& motion, const LegCosts& costs);

}  // namespace skycap::flight
