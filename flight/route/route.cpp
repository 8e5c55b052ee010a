#include "flight/route/route.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "flight/motion/flight_time_range.h"
#include "flight/route/curved_flight.h"
#include "flight/route/pad_check.h"
#include "flight/route/route_legs.h"
#include "flight/route/sortie_split.h"
#include "flight/route/tour.h"
#include "flight/way_home/ways_home.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Planner of one route. Members hold intermediate results of its stages.
class RoutePlanner {
 public:
  RoutePlanner(const Vehicle& vehicle, const FreeSpace& space, const RouteOptions& options)
      : space_(space), legs_(vehicle, space, options) {
    route_.vehicle = vehicle;
    route_.options = options;
    route_.clearance = options.clearance.total();
    route_.min_clearance = route_.clearance + reported_surplus;
  }

  Route plan(std::vector<Station> stations, const FreeSpace* pad_space) {
    check_pad(space_, pad_space, route_.options);
    legs_.take_flown(stations);
    stations = legs_.allowed(std::move(stations));
    if (route_.options.order_is_free) choose_order(stations);
    legs_.admit(stations);
    connect();
    split();
    add_up();
    if (legs_.returns() && !route_.sorties.empty()) certify_returns();
    add_curves(route_, space_, legs_.motion(), legs_.costs());
    return std::move(route_);
  }

 private:
  void choose_order(std::vector<Station>& stations) {
    const auto place = [&](std::uint32_t i) {
      return i == 0 ? legs_.home() : stations[i - 1].view.position;
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

  void connect() {
    route_.stations = legs_.stations();
    route_.unreached = legs_.unreached();
    route_.legs.clear();
    route_.station_length = route_.straight_length = 0.0;
    for (std::size_t i = 1; i < route_.stations.size(); ++i) {
      const Station &from = route_.stations[i - 1], &to = route_.stations[i];
      route_.legs.push_back(legs_.between(i - 1, i));
      route_.station_length += route_.legs.back().length;
      route_.straight_length += (to.view.position - from.view.position).norm();
    }
  }

  void split() {
    if (route_.stations.empty()) return;
    // Paths without a sortie need no returns. A single waypoint that has become too distant for the
    // battery would prevent every split.
    do {
      if (legs_.drop_out_of_range()) connect();
      split_once();
    } while (give_returns());
    if (route_.sorties.empty() && !route_.stations.empty()) {
      throw Error(ErrorKind::bad_config,
                  "no division of the route into sorties fits the battery; lower flight.reserve");
    }
  }

  void split_once() {
    SplitProblem problem;
    SplitProblem::Pad& pad = problem.pads.emplace_back();
    for (std::size_t i = 0; i < route_.stations.size(); ++i) {
      pad.out.push_back(legs_.out_cost(i));
      pad.back.push_back(legs_.back_cost(i));
      problem.station.push_back(legs_.station_cost(i));
      if (i > 0) problem.leg.push_back(cost_of(route_.legs[i - 1]));
    }
    problem.energy_per_sortie = plannable_energy(legs_.motion());
    problem.stations_per_sortie = most_stations(legs_.motion().vehicle());

    const SortieSplit split = split_into_sorties(problem);
    route_.duration = split.time;
    route_.duration_bound = split.time_bound;
    route_.sorties.clear();
    for (const SortieRange& range : split.sorties) {
      add_sortie(range, problem, legs_.out(range.first), legs_.back(range.last));
    }
  }

  /// Returns true if the path of a sortie was changed.
  bool give_returns() {
    bool has_changed = false;
    for (const Sortie& sortie : route_.sorties) {
      for (const std::uint32_t i : {sortie.first, sortie.last}) {
        has_changed = legs_.give_returns(i) || has_changed;
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
    sortie.energy_left = legs_.motion().usable_energy() - total.energy;
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

  void certify_returns() {
    std::vector<Segment> legs;
    for (const Sortie& sortie : route_.sorties) {
      const std::vector<Vector3d> points = sortie_points(route_, sortie);
      for (std::size_t i = 1; i < points.size(); ++i) legs.push_back({points[i - 1], points[i]});
    }
    ReturnLaw law = legs_.returns()->law();
    law.reserve = 0.0;
    ReturnSearch search =
        least_return(space_, legs, law, law.level, return_clearance(route_.clearance));
    if (!search.found) {
      const bool has_rally =  // DJI vehicles return only to their take-off point.
          std::ranges::find(law.dialects, Dialect::dji) == law.dialects.end();
      throw Error(ErrorKind::bad_config,
                  "no verified return altitude: " + search.why + "; move flight.takeoff" +
                      (has_rally ? ", add a rally point (flight.rally)" : "") +
                      " or raise site.max_height");
    }
    route_.returns = std::move(search.found);
    for (const Segment& leg : legs) {
      const double energy = return_energy(legs_.motion(), route_.returns->law, leg.to);
      route_.returns->energy = std::max(route_.returns->energy, energy);
    }
  }

  const FreeSpace& space_;
  RouteLegs legs_;
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
                  "view " + std::to_string(station.view_index) +
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
