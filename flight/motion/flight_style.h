/// What a pilot may choose about legs.
#pragma once

namespace skycap::flight {

/// How legs are flown between two stops.
enum class FlightStyle {
  stop,    ///< straight, with a stop in every corner: what every autopilot can be told
  blend,   ///< round the corners
  smooth,  ///< along one curve, or round the corners where that is faster
};

}  // namespace skycap::flight
