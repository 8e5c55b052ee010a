#include "flight/fleet/fleet_costs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "flight/route/leg_certifier.h"
#include "flight/space/obstacles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Fills in the costs of a vehicle whose straight legs take `time_of(displacement)`.
template <typename TimeOf>
FleetVehicle costs_of(std::span<const Station> stations, const FleetMember& member,
                      TimeOf time_of) {
  const KnownSpace nothing(Obstacles{});
  const std::optional<WaysHome> no_ways_home;
  const Motion& motion = member.motion;
  const LegCertifier legs(nothing, motion, 0.0, no_ways_home);
  const Vector3d home = member.pad + Vector3d(0.0, 0.0, member.takeoff_climb);
  const auto leg = [&](const Vector3d& way, const Station* from, const Station* to) {
    const double time = legs.aimed_time(time_of(way), from, to);
    return PartCost{time, motion.leg_energy(way, time), 0.0};
  };
  FleetVehicle vehicle{.energy_per_sortie = motion.usable_energy(),
                       .stations_per_sortie = most_stations(motion.vehicle())};
  vehicle.legs.resize(stations.size() * stations.size());
  for (std::uint32_t i = 0; i < stations.size(); ++i) {
    const Vector3d& place = stations[i].view.position;
    vehicle.out.push_back(
        in_turn(legs.takeoff_cost(member.takeoff_climb), leg(place - home, nullptr, nullptr)));
    vehicle.back.push_back(
        in_turn(leg(home - place, nullptr, nullptr), legs.landing_cost(member.takeoff_climb)));
    vehicle.station.push_back(legs.station_cost(stations[i]));
    for (std::uint32_t j = 0; j < stations.size(); ++j) {
      if (i == j) continue;
      vehicle.legs[i * stations.size() + j] =
          leg(stations[j].view.position - place, &stations[i], &stations[j]);
    }
  }
  return vehicle;
}

/// From rest to rest, whatever the way: the greater of the times that its shares along the straight
/// line and upright take at least, and of the time at full speed.
double least_leg_time(const Motion& motion, const Vector3d& way) {
  const double distance = way.norm();
  if (distance == 0.0) return 0.0;
  const MissionMode& mode = motion.vehicle().mode;
  const Vector3d direction = way / distance;
  const double level = direction.head<2>().norm(), up = std::abs(direction.z());
  const double along =
      rest_to_rest_time(distance, motion.conditions().cruise_speed,
                        level * mode.acceleration + up * mode.vertical_acceleration, mode.jerk);
  const double upright =
      rest_to_rest_time(std::abs(way.z()), way.z() > 0.0 ? mode.max_ascent : mode.max_descent,
                        mode.vertical_acceleration, mode.jerk);
  // Velocities that the limits allow are a convex set: no detour is faster than its straight line.
  const double at_speed = distance / motion.leg_speed(direction);
  return std::max({along, upright, at_speed}) + mode.settle_time;
}

}  // namespace

FleetVehicle straight_costs(std::span<const Station> stations, const FleetMember& member) {
  return costs_of(stations, member,
                  [&](const Vector3d& way) { return member.motion.leg_time(way); });
}

FleetVehicle least_costs(std::span<const Station> stations, const FleetMember& member) {
  return costs_of(stations, member,
                  [&](const Vector3d& way) { return least_leg_time(member.motion, way); });
}

}  // namespace skycap::flight
