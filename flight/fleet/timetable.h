/// When each sortie of a fleet takes off, so that no two vehicles come too near to each other.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "flight/fleet/separation.h"

namespace skycap::flight {

/// A sortie that is to be given a start.
struct FleetSortie {
  std::size_t vehicle = 0;
  std::size_t number = 0;  ///< of its vehicle's sorties, which are flown in that order
  FlightScript script;
  double jerk = 0.0;  ///< see TimedFlight
  std::size_t variant =
      0;  ///< of all its vehicle may fly: one of them is flown, with all its sorties
};

struct Timetable {
  std::vector<double> starts;         ///< by sortie [s]; of variants that are not flown 0
  std::vector<std::size_t> variants;  ///< by vehicle: which of them it flies
  double makespan = 0.0;              ///< until the last landing [s]
  double delay = 0.0;                 ///< of the last landing, beside no separation at all [s]
};

/// Starts of all sorties: none too near to another, a vehicle's next sortie begun when the one
/// before has landed (batteries are changed in no time). Vehicles take turns in every sequence, or
/// those with the longest work first if there are more than five; each sortie starts at the first
/// whole second after its vehicle is ready at which it is proven against all before it, at the
/// latest when all those have landed. Of its variants a vehicle flies the one that lands first so.
/// The sequence with the least makespan wins.
Timetable timetable(const std::vector<FleetSortie>& sorties, std::size_t vehicles,
                    const SeparationRule& rule);

}  // namespace skycap::flight
