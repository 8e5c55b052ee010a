#include "flight/route/leg_certifier.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

/// Autopilots need up to this many mission items for a station, and some around a sortie.
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

std::optional<Leg> LegCertifier::leg(const std::vector<Vector3d>& points, const Station* from,
                                     const Station* to) const {
  Leg leg;
  leg.points = points;
  leg.length = flight::length(points);
  leg.clearance = clearance_ + reported_surplus;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const LegProof proof =
        prove(space_, {points[i - 1], points[i]}, clearance_, clearance_ + reported_surplus);
    if (!proof.is_proven) return std::nullopt;
    leg.clearance = std::min(leg.clearance, proof.clearance);
    // Autopilots begin to turn when they leave for the station, which is in the last corner.
    const bool is_last = i + 1 == points.size();
    const Vector3d way = points[i] - points[i - 1];
    const double leg_time = motion_.leg_time(way);
    const double moving = is_last ? aimed_time(leg_time, from, to) : leg_time;
    leg.duration += moving;
    leg.energy += motion_.leg_energy(way, moving);
    // Between two points a return costs no more than from the dearer of them: level flight grows
    // with a distance, which is convex, climb and descent evenly.
    const double home = std::max(return_cost(points[i - 1]), return_cost(points[i]));
    leg.emergency = std::max(leg.emergency, leg.energy + home);
    if (is_last) break;
    leg.duration += corner_hold;
    leg.energy += motion_.hover_energy(corner_hold);
  }
  return leg;
}

double LegCertifier::aimed_time(double leg, const Station* from, const Station* to) const {
  if (from == nullptr || to == nullptr) return leg;
  const double turn = std::remainder(yaw_of(to->view) - yaw_of(from->view), 2.0 * std::numbers::pi);
  return motion_.aimed_time(leg, turn, pitch_of(to->view) - pitch_of(from->view));
}

LegCost LegCertifier::takeoff_cost(double climb) const {
  return {motion_.takeoff_time(climb) + corner_hold,
          motion_.takeoff_energy(climb) + motion_.hover_energy(corner_hold)};
}

LegCost LegCertifier::landing_cost(double climb) const {
  const double time = corner_hold + motion_.landing_time(climb);
  return {time, motion_.hover_energy(time)};
}

LegCost LegCertifier::station_cost(const Station& station) const {
  const double hold = std::max(corner_hold, station.hold) + station.hold_after;
  const double energy = motion_.hover_energy(hold);
  return {hold, energy, energy + return_cost(station.view.position)};
}

double LegCertifier::return_cost(const Vector3d& place) const {
  return ways_home_ ? return_energy(motion_, ways_home_->law(), place) : 0.0;
}

}  // namespace skycap::flight
