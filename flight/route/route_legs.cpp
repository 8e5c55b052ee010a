#include "flight/route/route_legs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "flight/motion/flight_time_range.h"
#include "flight/space/place_text.h"

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

std::vector<Vector3d> reversed(const std::vector<Vector3d>& way) {
  return {way.rbegin(), way.rend()};
}

/// Returns true if the survey flew from `from` to the waypoint.
bool is_flown(const Vector3d& from, const Station& to) {
  return !to.way.empty() && to.way.front() == from && to.way.back() == to.view.position;
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

void RouteLegs::refuse(const Station& station, const std::string& reason) {
  unreached_.push_back({station, reason});
}

std::vector<Station> RouteLegs::allowed(std::vector<Station> stations) {
  std::erase_if(stations, [&](const Station& station) {
    const std::string why = why_not_allowed(station);
    if (!why.empty()) refuse(station, why);
    return !why.empty();
  });
  if (options_.returns) keep_with_return(stations);
  return stations;
}

std::string RouteLegs::why_not_allowed(const Station& station) const {
  const Vehicle& vehicle = motion_.vehicle();
  if (!can_look(vehicle, station.view)) {
    return "the gimbal of \"" + vehicle.name + "\" cannot look in that direction";
  }
  const Segment place{station.view.position, station.view.position};
  if (space_.is_free(place, clearance_)) return "";
  const Closest closest = space_.closest(place, clearance_ + 1.0);
  return "it is " + length_text(closest.distance) + " from " + space_.name(closest);
}

/// Removes waypoints without a verified return.
void RouteLegs::keep_with_return(std::vector<Station>& stations) {
  double top = home_.z();
  for (const Station& station : stations) top = std::max(top, station.view.position.z());
  planner_.require_returns(planning_law(options_, top), home_);
  std::erase_if(stations, [&](const Station& station) {
    const std::string why = returns()->why_none(station.view.position);
    if (!why.empty()) refuse(station, "no verified return: " + why);
    return !why.empty();
  });
}

/// Returns the path from above the pad to a waypoint, empty if none exists. Candidates in order are
/// the flown path, if the order is that of the survey and it is still free; the shortest path
/// found; and the complete path of the survey up to the waypoint.
std::vector<Vector3d> RouteLegs::from_home(const Station& to) {
  if (std::vector<Vector3d> way = flown(home_, to); !way.empty() && is_free(way)) return way;
  Path path = planner_.wide_or_narrow_path(home_, to.view.position);
  return path.status == PathStatus::found ? std::move(path.points) : all_flown(to);
}

bool RouteLegs::is_free(const std::vector<Vector3d>& way) const {
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (!space_.is_free({way[i - 1], way[i]}, clearance_)) return false;
  }
  return true;
}

/// Returns the path that the survey flew. Empty if it did not fly there, or if the order differs.
std::vector<Vector3d> RouteLegs::flown(const Vector3d& from, const Station& to) const {
  return !options_.order_is_free && is_flown(from, to) ? to.way : std::vector<Vector3d>();
}

std::vector<Vector3d> RouteLegs::all_flown(const Station& to) const {
  std::vector<Vector3d> way = {home_};
  for (const Station& next : flown_) {
    if (!is_flown(way.back(), next)) return {};
    way.insert(way.end(), next.way.begin() + 1, next.way.end());
    if (next.view_index == to.view_index) return planner_.pulled_tight(std::move(way));
  }
  return {};
}

void RouteLegs::admit(const std::vector<Station>& allowed) {
  // Waypoints without a path are listed before those whose path cannot be flown.
  std::vector<std::vector<Vector3d>> ways;
  for (const Station& station : allowed) {
    ways.push_back(from_home(station));
    if (!ways.back().empty()) continue;
    refuse(station, "no path to it with a clearance of " + length_text(clearance_));
  }
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    if (ways[i].empty()) continue;
    std::optional<Ends> ends = ends_along(std::move(ways[i]));
    const std::string why =
        ends ? why_out_of_range(allowed[i], *ends)
             : "the path to it cannot be verified with a clearance of " + length_text(clearance_);
    if (!why.empty()) {
      refuse(allowed[i], why);
      continue;
    }
    stations_.push_back(allowed[i]);
    ends_.push_back(*std::move(ends));
  }
}

/// Returns std::nullopt if the path cannot be verified in both directions.
std::optional<RouteLegs::Ends> RouteLegs::ends_along(std::vector<Vector3d> way) const {
  std::optional<VerifiedPath> out = planner_.verified(way);
  std::optional<VerifiedPath> back = planner_.verified(reversed(way));
  if (!out || !back) return std::nullopt;
  return Ends{std::move(way), costs_.leg(*std::move(out), nullptr, nullptr),
              costs_.leg(*std::move(back), nullptr, nullptr)};
}

std::string RouteLegs::why_out_of_range(const Station& station, const Ends& ends) const {
  const LegCost there = in_turn(takeoff_cost_, cost_of(ends.out));
  const LegCost home = in_turn(cost_of(ends.back), landing_cost_);
  const LegCost total = in_turn(in_turn(there, costs_.station_cost(station)), home);
  const double needed = std::max(total.energy, total.emergency);
  const double held = plannable_energy(motion_), longest = options_.conditions.longest_flight;
  if (needed <= held) return "";
  return "the flight there and back needs " + std::to_string(needed / 3600) +
         " Wh; the battery has " + std::to_string(held / 3600) + " Wh above its reserve" +
         (longest > 1.0 ? " for a flight that may take " + std::to_string(longest) +
                              " times the estimated time"
                        : "");
}

bool RouteLegs::drop_out_of_range() {
  std::vector<Station> stations;
  std::vector<Ends> ends;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    const std::string why = why_out_of_range(stations_[i], ends_[i]);
    if (!why.empty()) {
      refuse(stations_[i], why);
      continue;
    }
    stations.push_back(stations_[i]);
    ends.push_back(ends_[i]);
  }
  if (stations.size() == stations_.size()) return false;
  stations_ = std::move(stations);
  ends_ = std::move(ends);
  return true;
}

bool RouteLegs::give_returns(std::size_t station) {
  Ends& ends = ends_[station];
  if (!returns() || ends.has_returns) return false;
  ends.has_returns = true;
  std::vector<Vector3d> way = planner_.with_returns(ends.way);
  if (way == ends.way) return false;
  std::optional<Ends> changed = ends_along(std::move(way));
  if (!changed) return false;  // The verification of returns reports the position.
  ends = *std::move(changed);
  ends.has_returns = true;
  return true;
}

std::optional<Leg> RouteLegs::along(std::vector<Vector3d> way, std::size_t from,
                                    std::size_t to) const {
  if (way.empty()) return std::nullopt;
  std::optional<VerifiedPath> path = planner_.verified(planner_.with_returns(std::move(way)));
  if (!path) return std::nullopt;
  return costs_.leg(*std::move(path), &stations_[from], &stations_[to]);
}

Leg RouteLegs::by_home(std::size_t from, std::size_t to) const {
  // Both waypoints are connected to the pad, so a long path always exists.
  std::vector<Vector3d> points = reversed(ends_[from].way);
  points.insert(points.end(), ends_[to].way.begin() + 1, ends_[to].way.end());
  if (auto leg = along(planner_.pulled_tight(points), from, to)) return *std::move(leg);
  VerifiedPath parts = planner_.verified(std::move(points)).value();  // Each part was verified.
  return costs_.leg(std::move(parts), &stations_[from], &stations_[to]);
}

Leg RouteLegs::between(std::size_t from, std::size_t to) {
  const Vector3d &place = stations_[from].view.position, &next = stations_[to].view.position;
  if (auto leg = along(flown(place, stations_[to]), from, to)) return *std::move(leg);
  if (auto leg = along(planner_.path(place, next).points, from, to)) return *std::move(leg);
  return by_home(from, to);
}

LegCost RouteLegs::out_cost(std::size_t station) const {
  return in_turn(takeoff_cost_, cost_of(out(station)));
}

LegCost RouteLegs::back_cost(std::size_t station) const {
  return in_turn(cost_of(back(station)), landing_cost_);
}

LegCost RouteLegs::station_cost(std::size_t station) const {
  return costs_.station_cost(stations_[station]);
}

}  // namespace skycap::flight
