/// Stations that several vehicles share, and what each part of a flight takes each of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flight/route/sortie_split.h"

namespace skycap::flight {

using PartCost = SplitProblem::Cost;

/// What one vehicle's flights are made of, from its own pad; by station.
struct FleetVehicle {
  std::vector<PartCost> out;      ///< pad to station, take-off included
  std::vector<PartCost> station;  ///< what is done there
  std::vector<PartCost> back;     ///< station to pad, landing included
  std::vector<PartCost> legs;     ///< from station i to station j at [i * count + j]
  double energy_per_sortie = 0.0;
  std::size_t stations_per_sortie = 0;

  std::size_t count() const { return out.size(); }
  const PartCost& leg(std::uint32_t i, std::uint32_t j) const { return legs[i * count() + j]; }
  PartCost& leg(std::uint32_t i, std::uint32_t j) { return legs[i * count() + j]; }
};

/// One vehicle at least; all with the same stations.
struct FleetProblem {
  std::vector<FleetVehicle> vehicles;

  std::size_t count() const { return vehicles.front().count(); }
};

}  // namespace skycap::flight
