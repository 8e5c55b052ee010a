#include "flight/route/route_legs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "flight/clearance/position_text.h"
#include "flight/motion/flight_time_range.h"

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

std::vector<Vector3d> reversed(const std::vector<Vector3d>& approach_path) {
  return {approach_path.rbegin(), approach_path.rend()};
}

constexpr const char* out_of_range_remedy =
    "move flight.takeoff closer to the view or lower flight.reserve";

/// Returns true if the survey flew from `from` to the waypoint.
bool is_executed(const Vector3d& from, const CapturePoint& to) {
  return !to.approach_path.empty() && to.approach_path.front() == from &&
         to.approach_path.back() == to.view.position;
}

}  // namespace

RouteLegs::RouteLegs(const Vehicle& vehicle, const FreeSpace& space, const RouteOptions& options)
    : motion_(vehicle, options.conditions),
      space_(space),
      options_(options),
      clearance_(options.clearance.total()),
      home_(options.takeoff + Vector3d(0.0, 0.0, options.takeoff_climb)),
      planner_(space, clearance_, options.path),
      costs_(motion_, &planner_.returns()),
      takeoff_cost_(costs_.takeoff_cost(options.takeoff_climb)),
      landing_cost_(costs_.landing_cost(options.takeoff_climb)) {}

void RouteLegs::reject(const CapturePoint& capture_point, const std::string& reason,
                       const std::string& remedy) {
  unreached_.push_back({capture_point, reason + "; " + remedy});
}

std::vector<CapturePoint> RouteLegs::allowed(std::vector<CapturePoint> capture_points) {
  std::erase_if(capture_points, [&](const CapturePoint& capture_point) {
    const std::string reason = rejection_reason(capture_point);
    if (!reason.empty()) {
      reject(capture_point, reason,
             can_aim(motion_.vehicle(), capture_point.view)
                 ? "lower flight.clearance"
                 : "set limits.max_pitch_deg and limits.min_pitch_deg to the range of the gimbal, "
                   "and plan the mission again");
    }
    return !reason.empty();
  });
  if (options_.returns) keep_with_return(capture_points);
  return capture_points;
}

std::string RouteLegs::rejection_reason(const CapturePoint& capture_point) const {
  const Vehicle& vehicle = motion_.vehicle();
  if (!can_aim(vehicle, capture_point.view)) {
    return "the gimbal of \"" + vehicle.name + "\" cannot look in that direction";
  }
  const Segment position{capture_point.view.position, capture_point.view.position};
  if (space_.is_free(position, clearance_)) return "";
  const Closest closest = space_.closest(position, clearance_ + 1.0);
  return "it is " + length_text(closest.distance) + " from " + space_.name(closest);
}

/// Removes waypoints without a verified return.
void RouteLegs::keep_with_return(std::vector<CapturePoint>& capture_points) {
  double top = home_.z();
  for (const CapturePoint& capture_point : capture_points)
    top = std::max(top, capture_point.view.position.z());
  planner_.require_returns(planning_rtl_profile(options_, top), home_);
  std::erase_if(capture_points, [&](const CapturePoint& capture_point) {
    const NoReturn none = returns()->no_return_reason(capture_point.view.position);
    if (none) reject(capture_point, "no verified return: " + none.reason, none.remedy);
    return bool{none};
  });
}

/// Returns the path from above the pad to a waypoint, empty if none exists. Candidates in order are
/// the flown path, if the order is that of the survey and it is still free; the shortest path
/// found; and the complete path of the survey up to the waypoint.
std::vector<Vector3d> RouteLegs::path_from_home(const CapturePoint& to) {
  if (std::vector<Vector3d> approach_path = executed_path(home_, to);
      !approach_path.empty() && is_free(approach_path))
    return approach_path;
  Path path = planner_.wide_or_narrow_path(home_, to.view.position);
  return path.status == PathStatus::found ? std::move(path.points) : whole_executed_path(to);
}

bool RouteLegs::is_free(const std::vector<Vector3d>& approach_path) const {
  for (std::size_t i = 1; i < approach_path.size(); ++i) {
    if (!space_.is_free({approach_path[i - 1], approach_path[i]}, clearance_)) return false;
  }
  return true;
}

/// Returns the path that the survey flew. Empty if it did not fly there, or if the order differs.
std::vector<Vector3d> RouteLegs::executed_path(const Vector3d& from, const CapturePoint& to) const {
  return !options_.order_is_free && is_executed(from, to) ? to.approach_path
                                                          : std::vector<Vector3d>();
}

std::vector<Vector3d> RouteLegs::whole_executed_path(const CapturePoint& to) const {
  std::vector<Vector3d> approach_path = {home_};
  for (const CapturePoint& next : executed_) {
    if (!is_executed(approach_path.back(), next)) return {};
    approach_path.insert(approach_path.end(), next.approach_path.begin() + 1,
                         next.approach_path.end());
    if (next.view_index == to.view_index) return planner_.pulled_tight(std::move(approach_path));
  }
  return {};
}

void RouteLegs::admit(const std::vector<CapturePoint>& allowed) {
  // Waypoints without a path are listed before those whose path cannot be flown.
  std::vector<std::vector<Vector3d>> paths;
  for (const CapturePoint& capture_point : allowed) {
    paths.push_back(path_from_home(capture_point));
    if (!paths.back().empty()) continue;
    reject(capture_point, "no path to it with a clearance of " + length_text(clearance_),
           "lower flight.clearance or move flight.takeoff");
  }
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    if (paths[i].empty()) continue;
    std::optional<Ends> ends = ends_along(std::move(paths[i]));
    const std::string reason =
        ends ? range_error(allowed[i], *ends)
             : "the path to it cannot be verified with a clearance of " + length_text(clearance_);
    if (!reason.empty()) {
      reject(allowed[i], reason, ends ? out_of_range_remedy : "lower flight.clearance");
      continue;
    }
    capture_points_.push_back(allowed[i]);
    ends_.push_back(*std::move(ends));
  }
}

/// Returns std::nullopt if the path cannot be verified in both directions.
std::optional<RouteLegs::Ends> RouteLegs::ends_along(std::vector<Vector3d> approach_path) const {
  std::optional<VerifiedPath> out = planner_.verified(approach_path);
  std::optional<VerifiedPath> back = planner_.verified(reversed(approach_path));
  if (!out || !back) return std::nullopt;
  return Ends{std::move(approach_path), costs_.leg(*std::move(out), nullptr, nullptr),
              costs_.leg(*std::move(back), nullptr, nullptr)};
}

std::string RouteLegs::range_error(const CapturePoint& capture_point, const Ends& ends) const {
  const LegCost there = in_turn(takeoff_cost_, compute_cost(ends.out));
  const LegCost home = in_turn(compute_cost(ends.back), landing_cost_);
  const LegCost total = in_turn(in_turn(there, costs_.capture_cost(capture_point)), home);
  if (const std::size_t most = max_sortie_waypoints(motion_.vehicle()); total.waypoints > most) {
    return "the flight to it and back requires " + std::to_string(total.waypoints) +
           " waypoints; the vehicle accepts " + std::to_string(most);
  }
  const double needed = std::max(total.energy, total.emergency);
  const double held = plannable_energy(motion_), longest = options_.conditions.longest_flight;
  if (needed <= held) return "";
  return "the flight to it and back requires " + std::to_string(needed / 3600) +
         " Wh; the battery has " + std::to_string(held / 3600) + " Wh above its reserve" +
         (longest > 1.0
              ? " for a flight of up to " + std::to_string(longest) + " times the estimated time"
              : "");
}

bool RouteLegs::drop_out_of_range() {
  std::vector<CapturePoint> capture_points;
  std::vector<Ends> ends;
  for (std::size_t i = 0; i < capture_points_.size(); ++i) {
    const std::string reason = range_error(capture_points_[i], ends_[i]);
    if (!reason.empty()) {
      reject(capture_points_[i], reason, out_of_range_remedy);
      continue;
    }
    capture_points.push_back(capture_points_[i]);
    ends.push_back(ends_[i]);
  }
  if (capture_points.size() == capture_points_.size()) return false;
  capture_points_ = std::move(capture_points);
  ends_ = std::move(ends);
  return true;
}

bool RouteLegs::reroute_for_returns(std::size_t capture_point) {
  Ends& ends = ends_[capture_point];
  if (!returns() || ends.has_returns) return false;
  ends.has_returns = true;
  std::vector<Vector3d> approach_path = planner_.with_returns(ends.approach_path);
  if (approach_path == ends.approach_path) return false;
  std::optional<Ends> changed = ends_along(std::move(approach_path));
  if (!changed) return false;  // The verification of returns reports the position.
  ends = *std::move(changed);
  ends.has_returns = true;
  return true;
}

std::optional<Leg> RouteLegs::along(std::vector<Vector3d> approach_path, std::size_t from,
                                    std::size_t to) const {
  if (approach_path.empty()) return std::nullopt;
  std::optional<VerifiedPath> path =
      planner_.verified(planner_.with_returns(std::move(approach_path)));
  if (!path) return std::nullopt;
  return costs_.leg(*std::move(path), &capture_points_[from], &capture_points_[to]);
}

Leg RouteLegs::via_home(std::size_t from, std::size_t to) const {
  // Both waypoints are connected to the pad, so a long path always exists.
  std::vector<Vector3d> points = reversed(ends_[from].approach_path);
  points.insert(points.end(), ends_[to].approach_path.begin() + 1, ends_[to].approach_path.end());
  if (auto leg = along(planner_.pulled_tight(points), from, to)) return *std::move(leg);
  VerifiedPath parts = planner_.verified(std::move(points)).value();  // Each part was verified.
  return costs_.leg(std::move(parts), &capture_points_[from], &capture_points_[to]);
}

Leg RouteLegs::between(std::size_t from, std::size_t to) {
  const Vector3d &position = capture_points_[from].view.position,
                 &next = capture_points_[to].view.position;
  if (auto leg = along(executed_path(position, capture_points_[to]), from, to))
    return *std::move(leg);
  if (auto leg = along(planner_.path(position, next).points, from, to)) return *std::move(leg);
  return via_home(from, to);
}

LegCost RouteLegs::out_cost(std::size_t capture_point) const {
  return in_turn(takeoff_cost_, compute_cost(out(capture_point)));
}

LegCost RouteLegs::back_cost(std::size_t capture_point) const {
  return in_turn(compute_cost(back(capture_point)), landing_cost_);
}

LegCost RouteLegs::capture_cost(std::size_t capture_point) const {
  return costs_.capture_cost(capture_points_[capture_point]);
}

}  // namespace skycap::flight
