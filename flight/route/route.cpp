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
#include "flight/rtl/return_paths.h"
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

  Route plan(std::vector<CapturePoint> capture_points, const FreeSpace* pad_space) {
    check_pad(space_, pad_space, route_.options);
    legs_.set_executed_capture_points(capture_points);
    capture_points = legs_.allowed(std::move(capture_points));
    if (route_.options.order_is_free) choose_order(capture_points);
    legs_.admit(capture_points);
    connect();
    split();
    add_up();
    if (legs_.returns() && !route_.sorties.empty()) verify_route_returns();
    add_curves(route_, space_, legs_.motion(), legs_.costs());
    return std::move(route_);
  }

 private:
  void choose_order(std::vector<CapturePoint>& capture_points) {
    const auto position = [&](std::uint32_t i) {
      return i == 0 ? legs_.home() : capture_points[i - 1].view.position;
    };
    const Tour tour = plan_tour(
        static_cast<std::uint32_t>(capture_points.size() + 1),
        [&](std::uint32_t a, std::uint32_t b) { return (position(a) - position(b)).norm(); });
    std::vector<CapturePoint> ordered;
    for (const std::uint32_t i : tour.order) ordered.push_back(capture_points[i - 1]);
    capture_points = std::move(ordered);
    route_.order_bound = tour.lower_bound;
    route_.order_length = tour.cost;
  }

  void connect() {
    route_.capture_points = legs_.capture_points();
    route_.unreached = legs_.unreached();
    route_.legs.clear();
    route_.capture_leg_length = route_.straight_length = 0.0;
    for (std::size_t i = 1; i < route_.capture_points.size(); ++i) {
      const CapturePoint &from = route_.capture_points[i - 1], &to = route_.capture_points[i];
      route_.legs.push_back(legs_.between(i - 1, i));
      route_.capture_leg_length += route_.legs.back().length;
      route_.straight_length += (to.view.position - from.view.position).norm();
    }
  }

  void split() {
    if (route_.capture_points.empty()) return;
    // Paths without a sortie need no returns. A single waypoint that has become too distant for the
    // battery would prevent every split.
    do {
      if (legs_.drop_out_of_range()) connect();
      split_once();
    } while (reroute_for_returns());
    if (route_.sorties.empty() && !route_.capture_points.empty()) {
      throw Error(
          ErrorKind::bad_config,
          "the route cannot be divided into sorties of one battery each within the vehicle's "
          "max_waypoints; lower flight.reserve");
    }
  }

  void split_once() {
    SplitProblem problem;
    SplitProblem::Pad& pad = problem.pads.emplace_back();
    for (std::size_t i = 0; i < route_.capture_points.size(); ++i) {
      pad.out.push_back(out_cost(i));
      pad.back.push_back(legs_.back_cost(i));
      problem.capture_point.push_back(legs_.capture_cost(i));
      if (i > 0) problem.leg.push_back(compute_cost(route_.legs[i - 1]));
    }
    problem.energy_per_sortie = plannable_energy(legs_.motion());
    const bool are_passed = std::ranges::any_of(route_.capture_points, &CapturePoint::is_passed);
    std::size_t& most = problem.capture_points_per_sortie;
    const Vehicle& vehicle = legs_.motion().vehicle();
    problem.waypoints_per_sortie = max_sortie_waypoints(vehicle);
    most = vehicle.needs_waypoint_per_photo() ? problem.waypoints_per_sortie
                                              : max_capture_points(vehicle, are_passed);
    if (are_passed && most > 1) --most;  // A sortie that resumes has one in addition.

    const SortieSplit split = split_into_sorties(problem);
    route_.duration = split.time;
    route_.duration_bound = split.time_bound;
    route_.sorties.clear();
    for (SortieRange range : split.sorties) {
      if (resumes_before(range.first)) --range.first;
      add_sortie(range, problem, legs_.out(range.first), legs_.back(range.last));
    }
  }

  /// Returns true if a sortie that begins with this capture point flies the leg before it, too.
  bool resumes_before(std::size_t capture_point) const {
    return capture_point > 0 && route_.capture_points[capture_point].leg_time > 0.0;
  }

  LegCost out_cost(std::size_t capture_point) const {
    if (!resumes_before(capture_point)) return legs_.out_cost(capture_point);
    LegCost cost =
        in_turn(legs_.out_cost(capture_point - 1), compute_cost(route_.legs[capture_point - 1]));
    ++cost.waypoints;  // the capture point at which the sortie resumes
    return cost;
  }

  /// Returns true if the path of a sortie was changed.
  bool reroute_for_returns() {
    bool has_changed = false;
    for (const Sortie& sortie : route_.sorties) {
      for (const std::uint32_t i : {sortie.first, sortie.last}) {
        has_changed = legs_.reroute_for_returns(i) || has_changed;
      }
    }
    return has_changed;
  }

  void add_sortie(const SortieRange& range, const SplitProblem& problem, const Leg& out,
                  const Leg& back) {
    Sortie sortie{range.first, range.last, out, back};
    LegCost total = in_turn(legs_.out_cost(range.first), problem.pads[0].back[range.last]);
    double length = out.length + back.length + 2.0 * route_.options.takeoff_climb;
    double clearance = std::min(out.clearance, back.clearance);
    for (std::uint32_t i = range.first; i <= range.last; ++i) {
      total = in_turn(total, problem.capture_point[i]);
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

  /// Adds the paths on which an interrupted vehicle brakes beyond a waypoint that it passes. They
  /// are so close that all others are within the slack of the proof.
  void add_braking(std::size_t index, std::vector<Segment>& legs) const {
    const CapturePoint& passed = route_.capture_points[index];
    if (!passed.is_passed || passed.leg_time <= 0.0) return;
    const Vector3d corner = passed.view.position;
    const Vector3d leg = corner - route_.capture_points[index - 1].view.position;
    const Vector3d next = route_.capture_points[index + 1].view.position - corner;
    if (leg.norm() == 0.0 || next.norm() == 0.0) return;
    const double speed =
        std::min(route_.options.conditions.cruise_speed, leg.norm() / passed.leg_time);
    const Vector3d in = leg.normalized(), out = next.normalized();
    const double braking = stopping_distance(route_.vehicle, speed * in);
    const double spread = braking * (out - in).norm();
    const auto count = static_cast<int>(std::ceil(spread / (2.0 * return_slack)));
    for (int i = 0; i <= count; ++i) {
      const double share = count > 0 ? static_cast<double>(i) / count : 0.0;
      const Vector3d direction = ((1.0 - share) * in + share * out).stableNormalized();
      legs.push_back({corner, corner + braking * direction});
    }
  }

  void verify_route_returns() {
    std::vector<Segment> legs;
    for (const Sortie& sortie : route_.sorties) {
      const std::vector<Vector3d> points = sortie_points(route_, sortie);
      for (std::size_t i = 1; i < points.size(); ++i) legs.push_back({points[i - 1], points[i]});
      for (std::uint32_t i = sortie.first + 1; i < sortie.last; ++i) add_braking(i, legs);
    }
    RtlProfile rtl_profile = legs_.returns()->rtl_profile();
    rtl_profile.reserve = 0.0;
    ReturnSearch search = min_return_altitude(space_, legs, rtl_profile, rtl_profile.level,
                                              return_clearance(route_.clearance));
    if (!search.found) {
      const bool has_rally =  // DJI vehicles return only to their take-off point.
          std::ranges::find(rtl_profile.autopilots, AutopilotType::dji) ==
          rtl_profile.autopilots.end();
      throw Error(ErrorKind::bad_config,
                  "no verified return altitude: " + search.reason + "; move flight.takeoff" +
                      (has_rally ? ", add a rally point (flight.rally)" : "") +
                      " or raise site.max_height");
    }
    route_.returns = std::move(search.found);
    for (const Segment& leg : legs) {
      const double energy = return_energy(legs_.motion(), route_.returns->rtl_profile, leg.to);
      route_.returns->energy = std::max(route_.returns->energy, energy);
    }
  }

  const FreeSpace& space_;
  RouteLegs legs_;
  Route route_;
};

}  // namespace

Route plan_route(std::vector<CapturePoint> capture_points, const Vehicle& vehicle,
                 const FreeSpace& space, const FreeSpace* pad_space, const RouteOptions& options) {
  options.validate();
  for (const CapturePoint& capture_point : capture_points) {
    if (!capture_point.view.position.allFinite() || !capture_point.view.direction.allFinite() ||
        !(capture_point.hold >= 0.0) || !(capture_point.hold_after >= 0.0) ||
        capture_point.captures < 0) {
      throw Error(
          ErrorKind::bad_geometry,
          "view " + std::to_string(capture_point.view_index) +
              " has a non-finite pose, a negative hold time or a negative number of photos");
    }
  }
  return RoutePlanner(vehicle, space, options).plan(std::move(capture_points), pad_space);
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
