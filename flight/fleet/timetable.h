/// Take-off times of a fleet's sorties that keep all vehicles separated.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "flight/fleet/separation.h"

namespace skycap::flight {

/// Sortie without a start time.
struct FleetSortie {
  std::size_t vehicle = 0;
  /// Index within the sorties of its vehicle, which are flown in that order.
  std::size_t number = 0;
  FlightScript script;
  double jerk = 0.0;  ///< See TimedFlight.
  std::size_t variant =
      /// Variant of the vehicle's flight. Each vehicle flies all sorties of exactly one variant.
      0;
};

struct Timetable {
  std::vector<double> starts;  ///< Start of each sortie [s], 0 for sorties of other variants.
  std::vector<std::size_t> variants;  ///< Selected variant of each vehicle.
  double makespan = 0.0;              ///< Time of the last landing [s].
  double delay = 0.0;  ///< Delay of the last landing compared with no separation [s].
};

/// Computes start times such that all sorties are separated and a vehicle's next sortie starts
/// after the previous landing (battery changes take no time).
///
/// Vehicles are scheduled in every possible sequence, or longest work first if there are more than
/// five. Each sortie starts at the first whole second at which it is verified against all earlier
/// ones, at the latest after their landings. A vehicle flies the variant that lands first. The
/// sequence with the minimum makespan wins.
Timetable timetable(const std::vector<FleetSortie>& sorties, std::size_t vehicles,
                    const SeparationRule& rule);

}  // namespace skycap::flight
