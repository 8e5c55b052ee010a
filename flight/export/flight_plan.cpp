#include "flight/export/flight_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

Waypoint corner(const Vector3d& position, double clearance) {
  Waypoint waypoint;
  waypoint.position = position;
  waypoint.hold = corner_hold;
  waypoint.clearance = clearance;
  return waypoint;
}

Waypoint stop(const CapturePoint& capture_point, double clearance) {
  Waypoint waypoint = corner(capture_point.view.position, clearance);
  waypoint.is_capture_point = true;
  waypoint.yaw = compute_yaw(capture_point.view);
  waypoint.pitch = compute_pitch(capture_point.view);
  waypoint.hold = std::max(corner_hold, capture_point.hold);
  waypoint.hold_after = capture_point.hold_after;
  waypoint.captures = capture_point.captures;
  waypoint.view_index = capture_point.view_index;
  waypoint.leg_time = capture_point.leg_time;
  if (capture_point.is_passed) {
    waypoint.is_passed = true;
    waypoint.hold = waypoint.hold_after = 0.0;
  }
  return waypoint;
}

/// Makes a waypoint a stop at the end of a sortie.
void rest_at(Waypoint& waypoint) {
  if (!waypoint.is_passed) return;
  waypoint.is_passed = false;
  waypoint.hold = corner_hold;
}

}  // namespace

FlightPlan flight_plan(const Route& route, std::size_t index, const std::string& name,
                       const Site& site, const Obstacles& rules, Corners corners) {
  site.validate();
  const Sortie& sortie = route.sorties.at(index);
  FlightPlan plan{
      name, site,         route.vehicle, route.options.conditions, route.options.takeoff,
      {},   rules.no_fly, rules.fence,   route.clearance,          route.returns};
  plan.priors = rules.priors;
  plan.photo = route.options.photo;
  plan.waypoints.push_back(corner(sortie.out.points.front(), sortie.out.clearance));
  if (corners == Corners::rounded && sortie.fly_through) {
    for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
      plan.passed.push_back(stop(route.capture_points[i], sortie.fly_through->clearance));
      plan.passed.back().position = sortie.fly_through->views[i - sortie.first].position;
      plan.passed.back().hold = plan.passed.back().hold_after = 0.0;
    }
    plan.waypoints.push_back(corner(sortie.back.points.back(), sortie.fly_through->clearance));
    plan.waypoints.back().fly_through = sortie.fly_through;
    return plan;
  }
  const auto add = [&](const Leg& leg, Waypoint end) {
    if (corners == Corners::rounded && leg.smooth) {
      end.curve = leg.smooth->curve;
      end.clearance = leg.smooth->clearance;
    } else {
      for (std::size_t i = 1; i + 1 < leg.points.size(); ++i) {
        plan.waypoints.push_back(corner(leg.points[i], leg.clearance));
      }
    }
    plan.waypoints.push_back(std::move(end));
  };
  const Leg* leg = &sortie.out;
  for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
    Waypoint end = stop(route.capture_points[i], leg->clearance);
    if (i == sortie.first || i == sortie.last) rest_at(end);
    // Paths around obstacles are flown with stops.
    if (i == sortie.first || leg->points.size() > 2) end.leg_time = 0.0;
    add(*leg, std::move(end));
    leg = i < sortie.last ? &route.legs[i] : &sortie.back;
  }
  add(sortie.back, corner(sortie.back.points.back(), sortie.back.clearance));
  return plan;
}

const Returns& FlightPlan::verified_returns() const {
  if (returns) return *returns;
  throw Error(ErrorKind::bad_config,
              "\"" + name + "\" has no verified return, but the file requires a return altitude");
}

double turn_radius(const FlightPlan& plan, std::size_t index) {
  const Waypoint& waypoint = plan.waypoints[index];
  if (!waypoint.is_passed) return 0.0;
  const double before = (waypoint.position - plan.waypoints[index - 1].position).norm();
  const double after = (plan.waypoints[index + 1].position - waypoint.position).norm();
  // DJI: the damping distances of two waypoints must not exceed their leg.
  constexpr double max_share = 0.4;
  constexpr double unit = 1e-3;  // of the values in files, in which 0 is the autopilot's default
  const double radius = std::min(acceptance_radius, max_share * std::min(before, after));
  return unit * std::max(1.0, std::floor(radius / unit));
}

double px4_turn_distance(const Eigen::Vector3d& leg, double radius) {
  // Fraction of the leg that lies within a distance of its end, in one direction.
  const auto fraction = [](double distance, double length) {
    return distance < length ? distance / length : 1.0;
  };
  const double accepted = leg.norm() * std::min(fraction(radius, leg.head<2>().norm()),
                                                fraction(px4_altitude_radius, std::abs(leg.z())));
  return std::max(accepted, std::min(radius, leg.norm()));
}

double turn_distance(const FlightPlan& plan, std::size_t index) {
  const Waypoint& waypoint = plan.waypoints[index];
  if (!waypoint.is_passed) return 0.0;
  const Eigen::Vector3d leg = waypoint.position - plan.waypoints[index - 1].position;
  switch (plan.vehicle.autopilot) {
    case AutopilotType::ardupilot:
      return 0.5 * leg.norm();
    case AutopilotType::px4:
      return px4_turn_distance(leg, turn_radius(plan, index));
    default:
      return turn_radius(plan, index);
  }
}

double leg_speed(const FlightPlan& plan, std::size_t index) {
  const Waypoint& waypoint = plan.waypoints[index];
  if (waypoint.leg_time <= 0.0) return plan.conditions.cruise_speed;
  constexpr double step = 0.1, rounding = 1e-6;
  const double length = (waypoint.position - plan.waypoints[index - 1].position).norm();
  const double steps = std::ceil(length / waypoint.leg_time / step - rounding);
  return std::min(plan.conditions.cruise_speed, step * std::max(1.0, steps));
}

Recording recorded_stretch(const FlightPlan& plan) {
  Recording recording;
  for (std::size_t i = 1; i + 1 < plan.waypoints.size(); ++i) {
    if (!plan.waypoints[i].is_passed) continue;
    if (recording.is_empty()) recording.first = i - 1;
    recording.last = i + 1;
  }
  return recording;
}

std::vector<Eigen::Vector3d> rally_points(const FlightPlan& plan) {
  if (!plan.returns) return {};
  const std::vector<Eigen::Vector3d>& landings = plan.returns->rtl_profile.landings;
  return {landings.begin() + 1, landings.end()};  // The first landing point is the pad.
}

FlatNoFly flat_no_fly(const FlightPlan& plan) {
  FlatNoFly flat;
  std::vector<Vector3d> points;
  for (const Waypoint& waypoint : plan.waypoints) points.push_back(waypoint.position);
  for (const Prism& prism : plan.no_fly) {
    Obstacles footprint;
    footprint.no_fly = {{prism.name, prism.footprint}};  // Unbounded in height.
    const KnownSpace space(footprint);
    bool is_kept_out = check_route(points, space, 0.0).empty();
    for (std::size_t i = 1; plan.returns && is_kept_out && i < points.size(); ++i) {
      is_kept_out =
          verify_returns(space, {points[i - 1], points[i]}, plan.returns->rtl_profile, 0.0)
              .is_verified;
    }
    if (is_kept_out) {
      flat.written.push_back(prism);
    } else {
      flat.left_out.push_back(prism.name);
    }
  }
  return flat;
}

std::vector<StopTime> stop_times(const FlightPlan& plan) {
  const Motion motion(plan.vehicle, plan.conditions);
  const Waypoint& above_pad = plan.waypoints.front();
  double now = motion.takeoff_time((above_pad.position - plan.pad).norm());
  std::vector<StopTime> times{{now, now, now + above_pad.hold, now + above_pad.hold}};
  const Waypoint* last_capture_point = nullptr;
  for (std::size_t i = 1; i < plan.waypoints.size(); ++i) {
    const Waypoint& waypoint = plan.waypoints[i];
    now = times.back().departure;
    const Curve* path_curve = waypoint.path_curve();
    const Vector3d straight = waypoint.position - plan.waypoints[i - 1].position;
    double leg = 0.0;
    if (path_curve != nullptr) {
      leg = duration(*path_curve) + plan.vehicle.mode.settle_time;
    } else {
      leg = waypoint.run ? run_time(plan, *waypoint.run, straight) : motion.leg_time(straight);
      if (waypoint.leg_time > 0.0) leg = waypoint.leg_time;
    }
    double aimed = now + leg;
    if (waypoint.is_capture_point && last_capture_point != nullptr && waypoint.leg_time == 0.0) {
      const double turn =
          std::remainder(waypoint.yaw - last_capture_point->yaw, 2.0 * std::numbers::pi);
      aimed = now + motion.aimed_time(leg, turn, waypoint.pitch - last_capture_point->pitch);
    }
    if (waypoint.is_capture_point) last_capture_point = &waypoint;
    const double capture = aimed + waypoint.hold;
    times.push_back({now + leg, aimed, capture, capture + waypoint.hold_after});
  }
  return times;
}

double run_time(const FlightPlan& plan, const PhotoRun& run, const Vector3d& path_curve) {
  Conditions conditions = plan.conditions;
  conditions.cruise_speed = std::min(conditions.cruise_speed, run.speed);
  return Motion(plan.vehicle, conditions).leg_time(path_curve);
}

double flight_time(const FlightPlan& plan) {
  const Motion motion(plan.vehicle, plan.conditions);
  const double descent = (plan.waypoints.back().position - plan.pad).norm();
  return stop_times(plan).back().departure + motion.landing_time(descent);
}

std::vector<Vector3d> local_points(const RouteFile& file, const Site& site, const Vector3d& pad) {
  const LocalFrame frame(site.origin);
  std::vector<Vector3d> points;
  points.reserve(file.points.size());
  for (const FilePoint& point : file.points) {
    double height = point.height;
    if (point.datum == HeightDatum::takeoff) height += frame.to_geodetic(pad).height;
    if (point.datum == HeightDatum::mean_sea_level) height += site.undulation_for("this route");
    points.push_back(frame.to_local({point.latitude_deg, point.longitude_deg, height}));
  }
  return points;
}

}  // namespace skycap::flight
