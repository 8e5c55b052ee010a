/// Splits an order of stations into sorties that a battery can fly.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace skycap::flight {

/// The time of a flight that is not possible.
inline constexpr double never = std::numeric_limits<double>::infinity();

/// Times [s] and energies [J] of the parts that sorties are made of; one entry for each station,
/// but `leg` has one less.
struct SplitProblem {
  struct Cost {
    double time = 0.0;
    double energy = 0.0;
    /// What must be left when the part begins, so that wherever in it something goes wrong there is
    /// energy for the return that the autopilot flies then.
    double emergency = 0.0;
  };
  struct Pad {
    std::vector<Cost> out;   ///< pad to station, take-off included
    std::vector<Cost> back;  ///< station to pad, landing included
  };
  std::vector<Pad> pads;      ///< a sortie begins and ends at one of them
  std::vector<Cost> station;  ///< what is done there
  std::vector<Cost> leg;      ///< station i to station i + 1
  double energy_per_sortie = 0.0;
  std::size_t stations_per_sortie = 0;
};

struct SortieRange {
  std::uint32_t first, last;
  std::uint32_t pad = 0;
};

struct SortieSplit {
  std::vector<SortieRange> sorties;  ///< empty if some station cannot be served at all
  double time = 0.0;
  double time_bound = 0.0;  ///< no split is faster
};

/// The fastest split in the given order, each sortie from the pad that is best for it (Beasley
/// 1983, split of a giant tour): at every station the energy used so far and the way home fit into
/// the battery, and so does what each part asks for an emergency. O(pads x stations x stations in a
/// sortie).
SortieSplit split_into_sorties(const SplitProblem& problem);

}  // namespace skycap::flight
