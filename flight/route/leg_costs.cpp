#include "flight/route/leg_costs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

/// Maximum number of mission items per waypoint, and per sortie.
constexpr int items_per_station = 8;
constexpr int items_per_sortie = 14;

}  // namespace

std::size_t most_stations(const Vehicle& vehicle) {
  return static_cast<std::size_t>(
      std::max(1, (vehicle.max_waypoints - items_per_sortie) / items_per_station));
}

LegCost cost_of(const Leg& leg) { return {leg.duration, leg.energy, leg.emergency}; }

LegCost in_turn(const LegCost& first, const LegCost& second) {
  return {first.time + second.time, first.energy + second.energy,
          std::max(first.emergency, first.energy + second.emergency)};
}

Leg LegCosts::leg(VerifiedPath path, const Station* from, const Station* to) const {
  Leg leg;
  leg.points = std::move(path.points);
  leg.length = flight::length(leg.points);
  leg.clearance = path.clearance;
  const std::vector<Vector3d>& points = leg.points;
  for (std::size_t i = 1; i < points.size(); ++i) {
    // Autopilots start to rotate when they depart for the waypoint, which is at the last corner.
    const bool is_last = i + 1 == points.size();
    const Vector3d way = points[i] - points[i - 1];
    const double leg_time = motion_.leg_time(way);
    const double moving = is_last ? aimed_time(leg_time, from, to) : leg_time;
    leg.duration += moving;
    leg.energy += motion_.leg_energy(way, moving);
    // Between two points, a return costs no more than the more expensive of both. The cost of level
    // flight grows with a distance, which is convex; climb and descent are linear.
    const double home = std::max(return_cost(points[i - 1]), return_cost(points[i]));
    leg.emergency = std::max(leg.emergency, leg.energy + home);
    if (is_last) break;
    leg.duration += corner_hold;
    leg.energy += motion_.hover_energy(corner_hold);
  }
  return leg;
}

double LegCosts::aimed_time(double leg, const Station* from, const Station* to) const {
  if (from == nullptr || to == nullptr) return leg;
  const double turn = std::remainder(yaw_of(to->view) - yaw_of(from->view), 2.0 * std::numbers::pi);
  return motion_.aimed_time(leg, turn, pitch_of(to->view) - pitch_of(from->view));
}

LegCost LegCosts::takeoff_cost(double climb) const {
  return {motion_.takeoff_time(climb) + corner_hold,
          motion_.takeoff_energy(climb) + motion_.hover_energy(corner_hold)};
}

LegCost LegCosts::landing_cost(double climb) const {
  const double time = corner_hold + motion_.landing_time(climb);
  return {time, motion_.hover_energy(time)};
}

LegCost LegCosts::station_cost(const Station& station) const {
  const double hold = std::max(corner_hold, station.hold) + station.hold_after;
  const double energy = motion_.hover_energy(hold);
  return {hold, energy, energy + return_cost(station.view.position)};
}

double LegCosts::return_cost(const Vector3d& place) const {
  const bool is_required = returns_ != nullptr && returns_->has_value();
  return is_required ? return_energy(motion_, (*returns_)->law(), place) : 0.0;
}

}  // namespace skycap::flight
