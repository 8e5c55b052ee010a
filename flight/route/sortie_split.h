/// Splits an ordered sequence of waypoints into sorties within the battery capacity.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace skycap::flight {

/// Duration of an impossible flight.
inline constexpr double never = std::numeric_limits<double>::infinity();

/// Times [s] and energies [J] of the parts of sorties. Vectors have one entry per waypoint, `leg`
/// one less.
struct SplitProblem {
  struct Cost {
    double time = 0.0;
    double energy = 0.0;
    /// Energy required at the start of the part so that, from each of its points, the autopilot can
    /// still return [J].
    double emergency = 0.0;
    std::size_t waypoints = 0;  ///< Number of waypoints in a mission file.
  };
  struct Pad {
    std::vector<Cost> out;   ///< Pad to waypoint, including take-off.
    std::vector<Cost> back;  ///< Waypoint to pad, including landing.
  };
  std::vector<Pad> pads;            ///< Pads at which a sortie can start and end.
  std::vector<Cost> capture_point;  ///< Stops at waypoints.
  std::vector<Cost> leg;            ///< Legs from waypoint i to waypoint i + 1.
  double energy_per_sortie = 0.0;
  std::size_t capture_points_per_sortie = 0;
  std::size_t waypoints_per_sortie = std::numeric_limits<std::size_t>::max();
};

struct SortieRange {
  std::uint32_t first, last;
  std::uint32_t pad = 0;
};

struct SortieSplit {
  /// Sorties in order. Empty if a waypoint cannot be reached at all.
  std::vector<SortieRange> sorties;
  double time = 0.0;
  double time_bound = 0.0;  ///< Lower bound for every split [s].
};

/// Returns the fastest split in the given order, with the best pad for each sortie (Beasley 1983,
/// split of a giant tour). At every waypoint, the battery covers the energy used so far and the
/// flight back, as well as the emergency energy of each part. A sortie with its corners has at most
/// the maximum number of waypoints. Complexity: O(pads x waypoints x
/// waypoints per sortie).
SortieSplit split_into_sorties(const SplitProblem& problem);

}  // namespace skycap::flight
