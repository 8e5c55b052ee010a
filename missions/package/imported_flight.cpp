#include "missions/package/imported_flight.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "flight/clearance/interruptible_space.h"
#include "flight/export/export.h"
#include "flight/flown/track_simplification.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/package/fleet_report.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using flight::ImportedPoint;

/// Radius of the column above the pad in which positions belong to climb and landing [m].
constexpr double pad_column_radius = 3.0;

std::string leg_name(const flight::ImportedRoute& route, std::size_t leg) {
  return fmt::format("leg {} ({} to {})", leg + 1, route.points[leg].item,
                     route.points[leg + 1].item);
}

/// Lists the straight legs and the waypoints that are not free.
void verify_straight(ImportedFlight& flight, const flight::FreeSpace& space, double clearance,
                     const std::stop_token& stop) {
  std::vector<Vector3d> positions;
  for (const ImportedPoint& point : flight.route.points) positions.push_back(point.position);
  const auto certificates = verify_route(positions, space, clearance, clearance, stop);
  for (std::size_t i = 0; i < certificates.size(); ++i) {
    const auto& [verification, obstacle] = certificates[i];
    if (verification.is_verified) continue;
    ++flight.unverified_legs;
    const std::string leg = positions.size() > 1 ? leg_name(flight.route, i)
                                                 : "waypoint " + flight.route.points[i].item;
    flight.problems.push_back(leg + ": " +
                              describe(flight::Violation{i, verification.closest, obstacle})
                                  .substr(("leg " + std::to_string(i) + ": ").size()));
  }
}

/// Returns the heading of the leg to a waypoint, or from the first one [deg].
double leg_heading(const std::vector<ImportedPoint>& points, std::size_t i) {
  const auto heading = [](const Vector3d& leg) {
    return std::atan2(leg.x(), leg.y()) / geometry::radians_per_degree;
  };
  constexpr double min_leg = 0.01;
  for (std::size_t end = i; end > 0; --end) {
    const Vector3d leg = points[end].position - points[end - 1].position;
    if (leg.head<2>().norm() > min_leg) return heading(leg);
  }
  for (std::size_t begin = i; begin + 1 < points.size(); ++begin) {
    const Vector3d leg = points[begin + 1].position - points[begin].position;
    if (leg.head<2>().norm() > min_leg) return heading(leg);
  }
  return 0.0;
}

/// Lists the legs that the flight does not follow on a straight line.
std::vector<ChangedLeg> find_changed(const ImportedFlight& flight) {
  const flight::Route& route = flight.mission->route;
  const std::vector<ImportedPoint>& points = flight.route.points;
  std::vector<ChangedLeg> changed;
  for (std::size_t i = 0; i < route.legs.size(); ++i) {
    const std::size_t from = route.capture_points[i].view_index;
    const std::size_t to = route.capture_points[i + 1].view_index;
    if (route.legs[i].points.size() == 2 && to == from + 1) continue;
    const double straight = (points[to].position - points[from].position).norm();
    changed.push_back({points[from].item, points[to].item, straight, route.legs[i].length});
  }
  return changed;
}

}  // namespace

ImportedFlight simplify_import(flight::ImportedRoute route, const flight::FlightOptions& options,
                               const Vector3d& pad, const ImportOptions& import) {
  ImportedFlight flight;
  flight.positions = route.points.size();
  flight.on_pad = remove_pad_column(route, pad, pad_column_radius, options.climb());
  flight.tolerance = import.tolerance;
  if (!flight.tolerance && route.is_track) flight.tolerance = default_track_tolerance;
  if (flight.tolerance && !route.points.empty()) {
    std::vector<flight::TrackSample> samples;
    for (const ImportedPoint& point : route.points) {
      const bool is_kept = point.captures > 0 || point.hold > 0.0;
      samples.push_back({point.time, point.position, point.yaw_deg, point.pitch_deg, is_kept});
    }
    const flight::SimplifiedTrack simplified =
        simplify_track(samples, {.tolerance = *flight.tolerance});
    flight.deviation = simplified.deviation;
    std::vector<ImportedPoint> kept;
    for (const std::size_t i : simplified.kept) kept.push_back(std::move(route.points[i]));
    route.points = std::move(kept);
  }
  flight.route = std::move(route);
  return flight;
}

std::vector<flight::CapturePoint> import_capture_points(const flight::ImportedRoute& route,
                                                        const flight::FlightOptions& options,
                                                        ImportedCaptures captures) {
  const flight::Vehicle& vehicle = options.required_vehicle();
  const double level_pitch = std::clamp(0.0, vehicle.gimbal_min, vehicle.gimbal_max);
  std::vector<flight::CapturePoint> capture_points;
  for (std::size_t i = 0; i < route.points.size(); ++i) {
    const ImportedPoint& point = route.points[i];
    const double yaw = std::isfinite(point.yaw_deg) ? point.yaw_deg : leg_heading(route.points, i);
    const double pitch = std::isfinite(point.pitch_deg)
                             ? geometry::radians_per_degree * point.pitch_deg
                             : level_pitch;
    flight::CapturePoint capture;
    capture.view = {point.position,
                    flight::compute_direction({geometry::radians_per_degree * yaw, pitch})};
    capture.view_index = static_cast<std::uint32_t>(i);
    capture.captures = point.captures;
    if (captures == ImportedCaptures::all) capture.captures = std::max(1, point.captures);
    if (captures == ImportedCaptures::none) capture.captures = 0;
    const bool is_capture = capture.captures > 0;
    capture.hold = std::max(point.hold, is_capture ? options.rest_before() : 0.0);
    capture.hold_after = is_capture ? options.rest_after() : 0.0;
    if (i > 0) capture.approach_path = {route.points[i - 1].position, point.position};
    capture_points.push_back(std::move(capture));
  }
  return capture_points;
}

void plan_import(ImportedFlight& flight, const flight::FlightOptions& given,
                 const ImportSpace& space, const Vector3d& pad, const ImportOptions& import,
                 const std::stop_token& stop) {
  if (flight.route.points.empty()) {
    throw Error(ErrorKind::bad_file, "all positions are at the take-off point");
  }
  flight::FlightOptions options = with_fixed_order(given);
  options.style = flight::FlightStyle::stop;
  flight::Obstacles rules = options.rules();
  const flight::KnownSpace known(rules);
  const flight::KnownSpace known_over_pad(without_ground(std::move(rules)));
  const flight::JointSpace joint({space.space, &known});
  const flight::FreeSpace* over_pad = space.over_pad != nullptr ? space.over_pad : &known_over_pad;
  const flight::JointSpace joint_over_pad({over_pad, &known_over_pad});
  const flight::InterruptibleSpace interruptible(joint, stop);

  // The positions of files are rounded. The verification of files allows for it, too.
  flight::RouteOptions route = options.route(pad);
  const flight::ClearanceBudget required = route.clearance;
  route.clearance.margin = std::max(0.0, required.margin - flight::rounding_bound);
  verify_straight(flight, interruptible, route.clearance.total(), stop);
  if (!flight.problems.empty()) {
    if (!import.repairs) return;
    flight.problems.clear();
    flight.unverified_legs = 0;
    route.clearance = required;
  }
  SurveyMission mission;
  mission.image_motion = options.image_motion_bounds();
  route.landing_surfaces = options.landing_surfaces(pad, space.landing_surfaces);
  mission.route = plan_route(import_capture_points(flight.route, options, import.captures),
                             options.required_vehicle(), interruptible, &joint_over_pad, route);
  mission.route.options.clearance = required;
  mission.route.clearance = required.total();
  flight.mission = std::move(mission);
  for (const flight::Unreached& missed : flight.mission->route.unreached) {
    const std::string text =
        fmt::format("waypoint {}: {}", flight.route.points[missed.capture_point.view_index].item,
                    missed.reason);
    (import.repairs ? flight.skipped : flight.problems).push_back(text);
  }
  flight.changed = find_changed(flight);
  if (!import.repairs) {
    for (const ChangedLeg& leg : flight.changed) {
      // The straight leg is free, so that only the returns can require another path.
      flight.problems.push_back(
          fmt::format("leg from {} to {}: no verified return from part of it", leg.from, leg.to));
    }
  } else if (flight.mission->route.capture_points.empty()) {
    flight.problems = flight.skipped;
  }
  if (!flight.problems.empty()) flight.mission.reset();
}

namespace {

/// Returns the waypoints of each vehicle, or std::nullopt if the file names no vehicles.
std::optional<FleetOrders> find_orders(const flight::ImportedRoute& route, std::size_t vehicles) {
  FleetOrders orders(vehicles);
  for (std::size_t i = 0; i < route.points.size(); ++i) {
    const ImportedPoint& point = route.points[i];
    if (point.vehicle == 0) return std::nullopt;
    if (point.vehicle > vehicles) {
      throw Error(ErrorKind::bad_file,
                  fmt::format("{}: vehicle {} is unknown; the fleet has {}", point.item,
                              point.vehicle, support::counted(vehicles, "vehicle")));
    }
    orders[point.vehicle - 1].push_back(static_cast<std::uint32_t>(i));
  }
  return orders;
}

}  // namespace

void plan_fleet_import(ImportedFlight& flight, const flight::FlightOptions& given,
                       const ImportSpace& space, const Vector3d& pad, const ImportOptions& import,
                       unsigned threads, const std::stop_token& stop) {
  if (flight.route.points.empty()) {
    throw Error(ErrorKind::bad_file, "all positions are at the take-off point");
  }
  const std::optional<FleetOrders> orders = find_orders(flight.route, given.fleet.names.size());
  flight::FlightOptions options = with_fixed_order(given);
  options.style = flight::FlightStyle::stop;
  flight::Route all;
  all.capture_points = import_capture_points(flight.route, options, import.captures);
  all.options.takeoff = pad;
  flight.fleet =
      std::make_shared<FleetMission>(plan_fleet(options, *space.space, all, space.landing_surfaces,
                                                threads, stop, orders ? &*orders : nullptr));
  std::vector<std::string>& missed = import.repairs ? flight.skipped : flight.problems;
  const auto add = [&](const std::vector<flight::Unreached>& unreached, const std::string& whom) {
    for (const flight::Unreached& one : unreached) {
      missed.push_back(fmt::format("waypoint {}{}: {}",
                                   flight.route.points[one.capture_point.view_index].item, whom,
                                   one.reason));
    }
  };
  if (!orders) add(flight.fleet->unreached, "");
  SurveyMission mission;
  for (std::size_t v = 0; v < flight.fleet->members.size(); ++v) {
    const flight::Route& route = flight.fleet->members[v].route;
    add(route.unreached, fmt::format(" of vehicle {}", v + 1));
    if (mission.route.sorties.empty()) mission.route = route;
  }
  if (mission.route.sorties.empty()) flight.problems = missed;
  if (!flight.problems.empty()) return;
  mission.image_motion = options.image_motion_bounds();
  flight.mission = std::move(mission);
}

namespace {

/// Returns the numbers of waypoints and captures, and a warning for legs that DJI apps reject.
std::string waypoints_text(const std::vector<const flight::Route*>& routes) {
  // DJI Mobile SDK, DJIMutableWaypointMission: 0.5 to 2000 m between adjacent waypoints.
  constexpr double min_dji_leg = 0.5;
  std::size_t captures = 0, waypoints = 0, short_legs = 0;
  for (const flight::Route* route : routes) {
    waypoints += route->capture_points.size();
    for (const flight::CapturePoint& point : route->capture_points) {
      captures += point.captures > 0 ? 1 : 0;
    }
    if (route->vehicle.autopilot != flight::AutopilotType::dji) continue;
    for (const flight::Leg& leg : route->legs) short_legs += leg.length < min_dji_leg ? 1 : 0;
  }
  std::string text =
      fmt::format("  captures  at {} of {}\n", captures, support::counted(waypoints, "waypoint"));
  if (short_legs > 0) {
    text += fmt::format("  Warning: {} shorter than {:g} m, which DJI apps may reject\n",
                        support::counted(short_legs, "leg"), min_dji_leg);
  }
  return text;
}

/// Returns one line per vehicle, the separation and the timetable.
std::string vehicles_text(const FleetMission& fleet) {
  std::string text;
  for (std::size_t v = 0; v < fleet.members.size(); ++v) {
    const flight::Route& route = fleet.members[v].route;
    if (route.sorties.empty()) {
      text += fmt::format("  vehicle {} {}, no waypoint\n", v + 1,
                          fleet.members[v].flight.vehicle_name);
      continue;
    }
    text += fmt::format(
        "  vehicle {} {}, {}, {:.1f} m in {:.1f} min, {}; clearance minimum {:.2f} m, verified for "
        "every leg; required {:.2f} m\n",
        v + 1, route.vehicle.name, support::counted(route.capture_points.size(), "waypoint"),
        route.length, route.duration / 60.0, support::counted(route.sorties.size(), "sortie"),
        route.min_clearance, route.options.clearance.total());
  }
  return text + fleet_text(fleet, false);
}

}  // namespace

std::string import_text(const ImportedFlight& flight, const std::string& file,
                        const flight::FlightOptions& options) {
  std::string text =
      fmt::format("  route     {}: {}, {}, heights {}\n", file, flight.route.kind,
                  support::counted(flight.positions, "position"), flight.route.heights);
  if (flight.tolerance) {
    text += fmt::format("  simplified to {}, maximum deviation {:.3f} m, at most {:g} m allowed\n",
                        support::counted(flight.route.points.size(), "waypoint"), flight.deviation,
                        *flight.tolerance);
  }
  if (flight.on_pad > 0) {
    text += fmt::format("  take-off  {} at the take-off point replaced by the climb to {:g} m\n",
                        support::counted(flight.on_pad, "position"), options.climb());
  }
  for (const ChangedLeg& leg : flight.changed) {
    text += fmt::format("  repaired  leg from {} to {}: {:.1f} m instead of {:.1f} m\n", leg.from,
                        leg.to, leg.length, leg.straight);
  }
  std::vector<const flight::Route*> routes;
  if (flight.fleet) {
    for (const FleetMember& member : flight.fleet->members) routes.push_back(&member.route);
  } else if (flight.mission) {
    routes.push_back(&flight.mission->route);
  }
  if (flight.mission) text += waypoints_text(routes);
  for (const std::string& waypoint : flight.skipped) text += "  skipped   " + waypoint + "\n";
  for (const std::string& warning : flight.route.warnings) {
    text += "  Warning: " + warning + "\n";
  }
  if (flight.fleet) text += vehicles_text(*flight.fleet);
  return text;
}

}  // namespace skycap::missions::package
