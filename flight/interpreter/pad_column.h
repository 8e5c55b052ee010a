/// The climb from a pad and the descent to it.
#pragma once

#include <array>
#include <string>

#include "flight/interpreter/flown_route.h"

namespace skycap::flight {

/// Adds an upright stretch in the direction that it is flown in: up to `vouched` metres above its
/// foot it is over the pad, the rest of it is a leg like any other. `items` are those it leads
/// between.
void append_column(FlownRoute& route, const Segment& column,
                   const std::array<std::string, 2>& items, double vouched);

}  // namespace skycap::flight
