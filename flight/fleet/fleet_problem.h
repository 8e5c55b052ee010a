/// Waypoints shared by several vehicles, and the cost of each part of a flight per vehicle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flight/route/sortie_split.h"

namespace skycap::flight {

using PartCost = SplitProblem::Cost;

/// Costs of the flights of one vehicle from its own pad, per waypoint.
struct FleetVehicle {
  std::vector<PartCost> out;            ///< Pad to waypoint, including take-off.
  std::vector<PartCost> capture_point;  ///< Stop at the waypoint.
  std::vector<PartCost> back;           ///< Waypoint to pad, including landing.
  std::vector<PartCost> legs;           ///< Leg from waypoint i to waypoint j at [i * count + j].
  double energy_per_sortie = 0.0;
  std::size_t capture_points_per_sortie = 0;

  std::size_t count() const { return out.size(); }
  const PartCost& leg(std::uint32_t i, std::uint32_t j) const { return legs[i * count() + j]; }
  PartCost& leg(std::uint32_t i, std::uint32_t j) { return legs[i * count() + j]; }
};

/// Costs of at least one vehicle, all with the same waypoints.
struct FleetProblem {
  std::vector<FleetVehicle> vehicles;

  std::size_t count() const { return vehicles.front().count(); }
};

}  // namespace skycap::flight
