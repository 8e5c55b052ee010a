#include "flight/route/leg_costs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

/// Maximum number of mission items per waypoint, and per sortie.
constexpr int items_per_capture_point = 8, items_per_passed_point = 4;
constexpr int items_per_sortie = 14;

}  // namespace

std::size_t max_capture_points(const Vehicle& vehicle, bool are_passed) {
  const int items = are_passed ? items_per_passed_point : items_per_capture_point;
  return static_cast<std::size_t>(std::max(1, (vehicle.max_waypoints - items_per_sortie) / items));
}

std::size_t max_sortie_waypoints(const Vehicle& vehicle) {
  if (vehicle.autopilot != AutopilotType::dji) return std::numeric_limits<std::size_t>::max();
  return static_cast<std::size_t>(vehicle.max_waypoints);
}

LegCost compute_cost(const Leg& leg) {
  const std::size_t corners = std::max<std::size_t>(leg.points.size(), 2) - 2;
  return {leg.duration, leg.energy, leg.emergency, corners};
}

LegCost in_turn(const LegCost& first, const LegCost& second) {
  return {first.time + second.time, first.energy + second.energy,
          std::max(first.emergency, first.energy + second.emergency),
          first.waypoints + second.waypoints};
}

Leg LegCosts::leg(VerifiedPath path, const CapturePoint* from, const CapturePoint* to) const {
  Leg leg;
  leg.points = std::move(path.points);
  leg.length = flight::length(leg.points);
  leg.clearance = path.clearance;
  const std::vector<Vector3d>& points = leg.points;
  for (std::size_t i = 1; i < points.size(); ++i) {
    // Autopilots start to rotate when they depart for the waypoint, which is at the last corner.
    const bool is_last = i + 1 == points.size();
    const Vector3d displacement = points[i] - points[i - 1];
    if (to != nullptr && to->leg_time > 0.0 && points.size() == 2) {
      leg.duration = to->leg_time;
      leg.energy = to->leg_time * std::max(motion_.hover_power(),
                                           motion_.flight_power(displacement / to->leg_time));
    } else {
      const double leg_time = motion_.leg_time(displacement);
      const double moving = is_last ? aimed_time(leg_time, from, to) : leg_time;
      leg.duration += moving;
      leg.energy += motion_.leg_energy(displacement, moving);
    }
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

double LegCosts::aimed_time(double leg, const CapturePoint* from, const CapturePoint* to) const {
  if (from == nullptr || to == nullptr) return leg;
  const double turn =
      std::remainder(compute_yaw(to->view) - compute_yaw(from->view), 2.0 * std::numbers::pi);
  return motion_.aimed_time(leg, turn, compute_pitch(to->view) - compute_pitch(from->view));
}

LegCost LegCosts::takeoff_cost(double climb) const {
  return {motion_.takeoff_time(climb) + corner_hold,
          motion_.takeoff_energy(climb) + motion_.hover_energy(corner_hold), 0.0, 1};
}

LegCost LegCosts::landing_cost(double climb) const {
  const double time = corner_hold + motion_.landing_time(climb);
  return {time, motion_.hover_energy(time), 0.0, 1};
}

LegCost LegCosts::capture_cost(const CapturePoint& capture_point) const {
  const double hold = capture_point.is_passed
                          ? 0.0
                          : std::max(corner_hold, capture_point.hold) + capture_point.hold_after;
  const double energy = motion_.hover_energy(hold);
  return {hold, energy, energy + return_cost(capture_point.view.position), 1};
}

double LegCosts::return_cost(const Vector3d& position) const {
  const bool is_required = returns_ != nullptr && returns_->has_value();
  return is_required ? return_energy(motion_, (*returns_)->rtl_profile(), position) : 0.0;
}

}  // namespace skycap::flight
