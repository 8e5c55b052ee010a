/// Other ways to fly a certified route than from stop to stop: its legs as curves, or its sorties
/// past their views.
#pragma once

#include "flight/motion/motion.h"
#include "flight/route/leg_costs.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// Gives the route's legs and sorties the curves of the style that its options ask for, where they
/// are proven, have a way home from every point if the route has, and take neither more time nor
/// more energy than what the sortie has set aside.
void add_curves(Route& route, const FreeSpace& space, const Motion& motion, const LegCosts& costs);

}  // namespace skycap::flight
