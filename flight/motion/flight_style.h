/// Leg styles that the pilot can select.
#pragma once

namespace skycap::flight {

/// Style of flight along legs.
enum class FlightStyle {
  stop,    ///< Straight legs with a stop at every corner, supported by every autopilot.
  blend,   ///< Rounded corners.
  smooth,  ///< One smooth curve, or rounded corners where those are faster.
  pass,    ///< Rounded corners and fly-through capture without stops at views.
};

}  // namespace skycap::flight
