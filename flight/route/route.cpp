#include "flight/route/route.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "flight/route/curved_flight.h"
#include "flight/route/leg_certifier.h"
#include "flight/route/pad_check.h"
#include "flight/route/sortie_split.h"
#include "flight/route/station_ways.h"
#include "flight/route/tour.h"
#include "flight/space/place_text.h"
#include "flight/way_home/ways_home.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Plans one route; the members are its stages' intermediate results.
class RoutePlanner {
 public:
  RoutePlanner(const Vehicle& vehicle, const FreeSpace& space, const RouteOptions& options)
      : motion_(vehicle, options.conditions),
        space_(space),
        home_(options.takeoff + Vector3d(0.0, 0.0, options.takeoff_climb)),
        paths_(space, home_, options),
        legs_(space, motion_, options.clearance.total(), ways_home_),
        takeoff_cost_(legs_.takeoff_cost(options.takeoff_climb)),
        landing_cost_(legs_.landing_cost(options.takeoff_climb)) {
    route_.vehicle = vehicle;
    route_.options = options;
    route_.clearance = options.clearance.total();
    route_.min_clearance = route_.clearance + reported_surplus;
  }

  Route plan(std::vector<Station> stations, const FreeSpace* pad_space) {
    check_pad(space_, pad_space, route_.options);
    paths_.take_flown(stations);
    keep_allowed(stations);
    if (route_.options.returns) keep_with_return(stations);
    if (route_.options.order_is_free) choose_order(stations);
    keep_reachable(stations);
    keep_in_range();
    connect();
    split();
    add_up();
    if (ways_home_ && !route_.sorties.empty()) certify_returns();
    add_curves(route_, space_, motion_, legs_);
    return std::move(route_);
  }

 private:
  void refuse(const Station& station, const std::string& reason) {
    route_.unreached.push_back({station, reason});
  }

  /// Drops stations that the gimbal cannot look from, or that are not free themselves.
  void keep_allowed(std::vector<Station>& stations) {
    std::vector<Station> allowed;
    for (const Station& station : stations) {
      const Vehicle& vehicle = motion_.vehicle();
      if (!can_look(vehicle, station.view)) {
        refuse(station, "the gimbal of \"" + vehicle.name + "\" cannot look that way");
        continue;
      }
      const Segment place{station.view.position, station.view.position};
      if (!space_.is_free(place, route_.clearance)) {
        const Closest closest = space_.closest(place, route_.clearance + 1.0);
        refuse(station, "it is " + length_text(closest.distance) + " from " + space_.name(closest));
        continue;
      }
      allowed.push_back(station);
    }
    stations = std::move(allowed);
  }

  /// Drops stations that no vehicle can be called home from.
  void keep_with_return(std::vector<Station>& stations) {
    double top = home_.z();
    for (const Station& station : stations) top = std::max(top, station.view.position.z());
    ways_home_.emplace(space_, planning_law(route_.options, top), home_, route_.clearance);
    std::erase_if(stations, [&](const Station& station) {
      const std::string why = ways_home_->why_none(station.view.position);
      if (!why.empty()) refuse(station, "there is no certified way home: " + why);
      return !why.empty();
    });
  }

  void choose_order(std::vector<Station>& stations) {
    const auto place = [&](std::uint32_t i) {
      return i == 0 ? home_ : stations[i - 1].view.position;
    };
    const Tour tour =
        plan_tour(static_cast<std::uint32_t>(stations.size() + 1),
                  [&](std::uint32_t a, std::uint32_t b) { return (place(a) - place(b)).norm(); });
    std::vector<Station> ordered;
    for (const std::uint32_t i : tour.order) ordered.push_back(stations[i - 1]);
    stations = std::move(ordered);
    route_.order_bound = tour.lower_bound;
    route_.order_length = tour.cost;
  }

  /// A way from above the pad to each station decides which stations there are; the way back is the
  /// same reversed.
  void keep_reachable(const std::vector<Station>& stations) {
    for (const Station& station : stations) {
      const std::vector<Vector3d> way = paths_.from_home(station);
      if (way.empty()) {
        refuse(station, "there is no way to it at a clearance of " + length_text(route_.clearance));
        continue;
      }
      route_.stations.push_back(station);
      ways_.push_back(way);
    }
  }

  std::vector<Vector3d> way_home(std::size_t i) const {
    return {ways_[i].rbegin(), ways_[i].rend()};
  }

  /// Drops stations whose way cannot be proven in both directions, and those that a full battery
  /// cannot reach and return from.
  void keep_in_range() {
    std::vector<Station> stations;
    std::vector<std::vector<Vector3d>> ways;
    for (std::size_t i = 0; i < route_.stations.size(); ++i) {
      const std::optional<Leg> out = legs_.leg(ways_[i], nullptr, nullptr);
      const std::optional<Leg> back = legs_.leg(way_home(i), nullptr, nullptr);
      if (!out || !back) {
        refuse(route_.stations[i],
               "the way to it cannot be proven at a clearance of " + length_text(route_.clearance));
        continue;
      }
      const LegCost there = in_turn(takeoff_cost_, cost_of(*out));
      const LegCost home = in_turn(cost_of(*back), landing_cost_);
      const LegCost total = in_turn(in_turn(there, legs_.station_cost(route_.stations[i])), home);
      const double needed = std::max(total.energy, total.emergency);
      if (needed > motion_.usable_energy()) {
        refuse(route_.stations[i], "getting there and back takes " + std::to_string(needed / 3600) +
                                       " Wh; the battery has " +
                                       std::to_string(motion_.usable_energy() / 3600) +
                                       " Wh above its reserve");
        continue;
      }
      stations.push_back(route_.stations[i]);
      ways.push_back(ways_[i]);
      outward_.push_back(*out);
      homeward_.push_back(*back);
    }
    route_.stations = std::move(stations);
    ways_ = std::move(ways);
  }

  /// The leg from station i - 1 to station i.
  Leg connection(std::size_t i) {
    const Station &from = route_.stations[i - 1], &to = route_.stations[i];
    const auto leg_along = [&](std::vector<Vector3d> way) {
      return way.empty() ? std::nullopt : legs_.leg(with_returns(std::move(way)), &from, &to);
    };
    if (auto leg = leg_along(paths_.flown(from.view.position, to))) return *std::move(leg);
    if (auto leg = leg_along(paths_.found(from.view.position, to.view.position))) {
      return *std::move(leg);
    }
    // Both are connected to the pad, so there is a way, though a long one.
    std::vector<Vector3d> points = way_home(i - 1);
    points.insert(points.end(), ways_[i].begin() + 1, ways_[i].end());
    const std::vector<Vector3d> tight =
        pull_tight(space_, route_.clearance, points, route_.options.path.worthwhile_saving);
    if (auto leg = leg_along(tight)) return *std::move(leg);
    return legs_.leg(points, &from, &to).value();  // its two parts were proven
  }

  void connect() {
    for (std::size_t i = 1; i < route_.stations.size(); ++i) {
      const Station &from = route_.stations[i - 1], &to = route_.stations[i];
      route_.legs.push_back(connection(i));
      route_.station_length += route_.legs.back().length;
      route_.straight_length += (to.view.position - from.view.position).norm();
    }
  }

  void split() {
    if (route_.stations.empty()) return;
    // Ways that no sortie takes need no returns.
    do {
      split_once();
    } while (certify_ways());
  }

  void split_once() {
    SplitProblem problem;
    SplitProblem::Pad& pad = problem.pads.emplace_back();
    for (std::size_t i = 0; i < route_.stations.size(); ++i) {
      pad.out.push_back(in_turn(takeoff_cost_, cost_of(outward_[i])));
      pad.back.push_back(in_turn(cost_of(homeward_[i]), landing_cost_));
      problem.station.push_back(legs_.station_cost(route_.stations[i]));
      if (i > 0) problem.leg.push_back(cost_of(route_.legs[i - 1]));
    }
    problem.energy_per_sortie = motion_.usable_energy();
    problem.stations_per_sortie = most_stations(motion_.vehicle());

    const SortieSplit split = split_into_sorties(problem);
    route_.duration = split.time;
    route_.duration_bound = split.time_bound;
    route_.sorties.clear();
    for (const SortieRange& range : split.sorties) {
      add_sortie(range, problem, outward_[range.first], homeward_[range.last]);
    }
  }

  /// Whether a way that a sortie takes had to be changed.
  bool certify_ways() {
    if (!ways_home_) return false;
    has_returns_.resize(ways_.size(), false);
    bool has_changed = false;
    for (const Sortie& sortie : route_.sorties) {
      for (const std::uint32_t i : {sortie.first, sortie.last}) {
        if (has_returns_[i]) continue;
        has_returns_[i] = true;
        std::vector<Vector3d> way = with_returns(ways_[i]);
        if (way == ways_[i]) continue;
        std::swap(way, ways_[i]);
        std::optional<Leg> out = legs_.leg(ways_[i], nullptr, nullptr);
        std::optional<Leg> back = legs_.leg(way_home(i), nullptr, nullptr);
        if (!out || !back) {  // the returns' own proof will name the place
          std::swap(way, ways_[i]);
          continue;
        }
        outward_[i] = *std::move(out);
        homeward_[i] = *std::move(back);
        has_changed = true;
      }
    }
    return has_changed;
  }

  void add_sortie(const SortieRange& range, const SplitProblem& problem, const Leg& out,
                  const Leg& back) {
    Sortie sortie{range.first, range.last, out, back};
    LegCost total = in_turn(problem.pads[0].out[range.first], problem.pads[0].back[range.last]);
    double length = out.length + back.length + 2.0 * route_.options.takeoff_climb;
    double clearance = std::min(out.clearance, back.clearance);
    for (std::uint32_t i = range.first; i <= range.last; ++i) {
      total = in_turn(total, problem.station[i]);
      if (i == range.last) break;
      total = in_turn(total, problem.leg[i]);
      length += route_.legs[i].length;
      clearance = std::min(clearance, route_.legs[i].clearance);
    }
    sortie.duration = total.time;
    sortie.energy = total.energy;
    sortie.energy_left = problem.energy_per_sortie - total.energy;
    sortie.length = length;
    sortie.clearance = clearance;
    route_.sorties.push_back(std::move(sortie));
  }

  void add_up() {
    for (const Sortie& sortie : route_.sorties) {
      route_.length += sortie.length;
      route_.energy += sortie.energy;
      route_.min_clearance = std::min(route_.min_clearance, sortie.clearance);
    }
  }

  // ---- ways home -----------------------------------------------------------------------------

  std::vector<Vector3d> with_returns(std::vector<Vector3d> way) const {
    if (!ways_home_) return way;
    return ways_home_->with_returns(std::move(way), route_.options.path.worthwhile_saving);
  }

  void certify_returns() {
    std::vector<Segment> legs;
    for (const Sortie& sortie : route_.sorties) {
      const std::vector<Vector3d> points = sortie_points(route_, sortie);
      for (std::size_t i = 1; i < points.size(); ++i) legs.push_back({points[i - 1], points[i]});
    }
    ReturnLaw law = ways_home_->law();
    law.reserve = 0.0;
    ReturnSearch search =
        least_return(space_, legs, law, law.level, return_clearance(route_.clearance));
    if (!search.found) {
      throw Error(ErrorKind::bad_config, "there is no certified way home: " + search.why +
                                             "; move flight.takeoff, add a place to land to "
                                             "flight.rally or raise site.highest_height");
    }
    route_.returns = std::move(search.found);
    for (const Segment& leg : legs) {
      const double energy = return_energy(motion_, route_.returns->law, leg.to);
      route_.returns->energy = std::max(route_.returns->energy, energy);
    }
  }

  Motion motion_;
  const FreeSpace& space_;
  Vector3d home_;
  StationWays paths_;
  std::optional<WaysHome> ways_home_;  ///< if returns are asked for
  LegCertifier legs_;
  LegCost takeoff_cost_, landing_cost_;
  std::vector<std::vector<Vector3d>> ways_;  ///< from above the pad to each station kept
  std::vector<Leg> outward_, homeward_;      ///< along them, once the stations are in range
  std::vector<bool> has_returns_;            ///< the ways that have been looked at for returns
  Route route_;
};

}  // namespace

Route plan_route(std::vector<Station> stations, const Vehicle& vehicle, const FreeSpace& space,
                 const FreeSpace* pad_space, const RouteOptions& options) {
  options.validate();
  for (const Station& station : stations) {
    if (!station.view.position.allFinite() || !station.view.direction.allFinite() ||
        !(station.hold >= 0.0) || !(station.hold_after >= 0.0) || station.shots < 0) {
      throw Error(ErrorKind::bad_geometry,
                  "station " + std::to_string(station.view_index) +
                      " has a pose that is not finite, or a negative hold or number of shots");
    }
  }
  return RoutePlanner(vehicle, space, options).plan(std::move(stations), pad_space);
}

std::vector<Vector3d> sortie_points(const Route& route, const Sortie& sortie) {
  std::vector<Vector3d> points = sortie.out.points;
  const auto append = [&](const Leg& leg) {
    points.insert(points.end(), leg.points.begin() + 1, leg.points.end());
  };
  for (std::uint32_t i = sortie.first; i < sortie.last; ++i) append(route.legs[i]);
  append(sortie.back);
  return points;
}

}  // namespace skycap::flight
