/// Vertical climb from a pad and descent to it.
#pragma once

#include <array>
#include <string>

#include "flight/interpreter/interpreted_route.h"

namespace skycap::flight {

/// Adds a vertical piece in flight direction. Up to `checked_height` [m] above its foot it counts
/// as above the pad, where the pilot must check it. The rest is an ordinary leg. `items` are the
/// names of both ends.
void append_column(InterpretedRoute& route, const Segment& column,
                   const std::array<std::string, 2>& items, double checked_height);

}  // namespace skycap::flight
