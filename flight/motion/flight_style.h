/// What a pilot may choose about legs.
#pragma once

namespace skycap::flight {

/// How legs are flown.
enum class FlightStyle {
  stop,    ///< straight, with a stop in every corner: what every autopilot can be told
  blend,   ///< round the corners
  smooth,  ///< along one curve, or round the corners where that is faster
  pass,    ///< round the corners, and past the views: pictures are taken without a stop
};

}  // namespace skycap::flight
