/// Tolerances and time limits of a guided flight.
#pragma once

namespace skycap::missions::online {

struct GuidedLimits {
  /// Maximum distance from the current leg, by the vehicle's position estimate [m].
  double corridor = 1.0;
  double arrival = 0.3;  ///< Maximum distance from a stop at arrival [m].
  double hold = 0.5;     ///< Time at rest and aimed before a scan [s].
  /// Time limit for the first message and for a valid position estimate [s].
  double patience = 60.0;
  double pad_radius = 2.0;  ///< Maximum horizontal distance from the pad before take-off [m].
  /// Maximum error of the estimated height on the pad before take-off [m].
  double pad_height = 1.0;
};

}  // namespace skycap::missions::online
