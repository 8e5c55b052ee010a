#include "flight/fleet/fleet_costs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight/motion/flight_time_range.h"
#include "flight/route/leg_costs.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns a lower bound on the rest-to-rest time for any path, without settle time. It is the
/// maximum of the bounds along the straight line and vertically, and of the time at full speed.
double least_moving_time(const Motion& motion, const Vector3d& way) {
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
  // The permitted velocities are a convex set, so no detour is faster than the straight line.
  return std::max({along, upright, distance / motion.leg_speed(direction)});
}

double least_leg_time(const Motion& motion, const Vector3d& way) {
  if (way.isZero(0.0)) return 0.0;
  return least_moving_time(motion, way) + motion.vehicle().mode.settle_time;
}

/// Returns a lower bound on the extra time of corner stops, given that a ball of radius `shortfall`
/// around a position on the straight line is not free.
double least_corner_time(const Motion& motion, const Vector3d& way, double shortfall) {
  if (!(shortfall > 0.0)) return 0.0;
  const MissionMode& mode = motion.vehicle().mode;
  // Upper bounds on speed and acceleration in any direction. The time is a concave increasing
  // function of distance.
  const auto moving = [&](double distance) {
    return rest_to_rest_time(distance, motion.conditions().cruise_speed,
                             std::hypot(mode.acceleration, mode.vertical_acceleration), mode.jerk);
  };
  // A single corner is at least one ball radius from both ends, and its two pieces are no shorter
  // than the line. Their total time is minimal if one piece is as short as possible.
  const double in_two = moving(shortfall) + moving(std::max(shortfall, way.norm() - shortfall));
  const double slower = std::max(0.0, in_two - least_moving_time(motion, way));
  const double stop = mode.settle_time + corner_hold;
  return stop + std::min(slower, stop);
}

double shortfall(const Segment& line, const FreeSpace& space, double clearance) {
  const LegProof proof = prove(space, line, clearance, clearance + 1.0);
  if (proof.is_proven) return 0.0;
  return std::max(clearance_guard, clearance - proof.closest.distance);
}

}  // namespace

std::vector<double> leg_shortfalls(std::span<const Station> stations, const FreeSpace& space,
                                   double clearance) {
  const std::size_t count = stations.size();
  std::vector<double> shortfalls(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Segment line{stations[i].view.position, stations[j].view.position};
      shortfalls[i * count + j] = shortfalls[j * count + i] = shortfall(line, space, clearance);
    }
  }
  return shortfalls;
}

std::vector<double> home_shortfalls(std::span<const Station> stations, const Vector3d& home,
                                    const FreeSpace& space, double clearance) {
  std::vector<double> shortfalls;
  for (const Station& station : stations) {
    shortfalls.push_back(shortfall({home, station.view.position}, space, clearance));
  }
  return shortfalls;
}

FleetVehicle least_costs(std::span<const Station> stations, const FleetMember& member,
                         const Shortfalls& shortfalls) {
  const Motion motion(member.vehicle, member.options.conditions);
  const LegCosts costs(motion);
  const auto leg = [&](const Vector3d& way, double shortfall, const Station* from,
                       const Station* to) {
    const double moving = least_leg_time(motion, way) + least_corner_time(motion, way, shortfall);
    const double time = costs.aimed_time(moving, from, to);
    return PartCost{time, motion.leg_energy(way, time), 0.0};
  };
  const auto shortfall_in = [](const std::vector<double>& list, std::size_t i) {
    return list.empty() ? 0.0 : list[i];
  };
  const double climb = member.options.takeoff_climb;
  FleetVehicle vehicle{.energy_per_sortie = plannable_energy(motion),
                       .stations_per_sortie = most_stations(motion.vehicle())};
  vehicle.legs.resize(stations.size() * stations.size());
  for (std::uint32_t i = 0; i < stations.size(); ++i) {
    const Vector3d& place = stations[i].view.position;
    const Vector3d way = place - member.home();
    const double shortfall = shortfall_in(shortfalls.home, i);
    vehicle.out.push_back(
        in_turn(costs.takeoff_cost(climb), leg(way, shortfall, nullptr, nullptr)));
    vehicle.back.push_back(
        in_turn(leg(-way, shortfall, nullptr, nullptr), costs.landing_cost(climb)));
    vehicle.station.push_back(costs.station_cost(stations[i]));
    for (std::uint32_t j = 0; j < stations.size(); ++j) {
      if (i == j) continue;
      const std::size_t k = i * stations.size() + j;
      vehicle.legs[k] = leg(stations[j].view.position - place, shortfall_in(shortfalls.legs, k),
                            &stations[i], &stations[j]);
    }
  }
  return vehicle;
}

}  // namespace skycap::flight
