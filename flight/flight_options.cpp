#include "flight/flight_options.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "flight/clearance/prior_obstacle.h"
#include "flight/motion/flight_time_range.h"
#include "flight/rtl/rtl_profile.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// With a quarter of the clearance as voxel size, little free space near measurements is lost.
constexpr double voxels_per_clearance = 4.0;

/// Returns the distance of proposed positions from the unknown box [m], which exceeds the clearance
/// plus a voxel.
double distance_from_unknown(const FlightOptions& options) { return 2.0 * options.clearance; }

/// Returns the distance of pads from the unknown box [m]. Near home, DJI vehicles may land on the
/// spot instead of on the pad (RtlProfile). Those columns must not enter the box, which is extended
/// to whole voxels.
double pad_distance_from_unknown(const FlightOptions& options) {
  constexpr double voxel_margin = 1.0;
  const bool is_dji =
      options.has_vehicle() && options.required_vehicle().autopilot == AutopilotType::dji;
  const double needed = options.clearance + dji_lands_at_once + voxel_margin;
  return is_dji ? std::max(distance_from_unknown(options), needed) : distance_from_unknown(options);
}

/// No-fly volumes with a ceiling above this height are not flown over [m].
constexpr double no_flight_is_higher = 500.0;

/// Maximum cut of corners at fly-through views, relative to the view distance.
constexpr double max_cut_by_distance = 0.03;

/// Number of expanded grid vertices after which a view counts as unreachable: tenths of a second.
constexpr std::size_t max_expansions = 50'000;

}  // namespace

ClearanceBudget FlightOptions::budget() const {
  ClearanceBudget budget{.vehicle_radius = required_vehicle().radius,
                         .position_error = position_error,
                         .tracking_error = tracking_error,
                         .map_error = map_error,
                         .margin = 0.0};
  budget.margin = clearance - budget.total();
  return budget;
}

Vehicle FlightOptions::vehicle_for(Vehicle own, AutopilotType autopilot) const {
  if (own.autopilot == autopilot) return own;
  const auto other = std::ranges::find(substitutes, autopilot, &Vehicle::autopilot);
  assert(other != substitutes.end());
  own.autopilot = autopilot;
  own.mode = other->mode;
  if (autopilot == AutopilotType::dji) own.wpml = other->wpml;
  if (own.needs_waypoint_per_photo()) {  // The limits of an app do not apply to autopilots.
    own.app = MissionApp::pilot;
    own.max_waypoints = other->max_waypoints;
  }
  return own;
}

std::vector<Vector3d> FlightOptions::fleet_pads(const Vector3d& first) const {
  if (!fleet.pads.empty()) return fleet.pads;
  const bool is_west_or_east =
      first.x() < unknown_box.min().x() || first.x() > unknown_box.max().x();
  const Vector3d along = is_west_or_east ? Vector3d::UnitY() : Vector3d::UnitX();
  std::vector<Vector3d> pads{first};
  for (std::size_t i = 1; i < fleet.names.size(); ++i) {
    const double side = i % 2 == 1 ? 1.0 : -1.0;
    const double steps = static_cast<double>((i + 1) / 2);
    Vector3d pad = first + side * steps * (fleet.separation + 1.0) * along;
    pad.z() = ground_at(pad.head<2>());
    pads.push_back(pad);
  }
  return pads;
}

FlightOptions FlightOptions::for_vehicle(std::size_t number, const Vector3d& pad) const {
  FlightOptions own = *this;
  own.vehicle_name = fleet.names.at(number);
  own.vehicle = fleet.vehicles.at(number);
  own.takeoff = pad;
  own.order = VisitOrder::survey;
  own.fleet = {};
  return own;
}

FlightOptions FlightOptions::with_vehicles(const std::vector<std::size_t>& kept,
                                           const std::vector<Vector3d>& pads) const {
  FlightOptions some = *this;
  some.fleet.names.clear(), some.fleet.vehicles.clear(), some.fleet.pads.clear();
  for (const std::size_t v : kept) {
    some.fleet.names.push_back(fleet.names.at(v));
    some.fleet.vehicles.push_back(fleet.vehicles.at(v));
    some.fleet.pads.push_back(pads.at(v));
  }
  some.vehicle_name = some.fleet.names.front();
  some.vehicle = some.fleet.vehicles.front();
  some.takeoff = some.fleet.pads.front();
  if (kept.size() == 1) some.fleet = {};
  return some;
}

bool FlightOptions::is_in_known_airspace(const Vector3d& position) const {
  if (!has_vehicle()) return true;
  const double margin = distance_from_unknown(*this);
  return unknown_box.exteriorDistance(position) >= margin &&
         std::ranges::all_of(
             extra_unknown_boxes,
             [&](const AlignedBox3d& box) { return box.exteriorDistance(position) >= margin; }) &&
         std::ranges::all_of(airspace.priors, [&](const auto& obstacle) {
           return obstacle->closest({position, position}, margin).distance >= margin;
         });
}

MeasuredSpaceConfig FlightOptions::measured_space() const {
  const double voxel = clearance / voxels_per_clearance;
  return {.voxel = voxel,
          .depth_margin = map_error,
          .free_without_return = free_without_return,
          .max_depth = std::min(capture.camera.max_range, 1e4 * voxel),
          .region = unknown_box,
          .extra_boxes = extra_unknown_boxes,
          .floor = airspace.terrain ? std::nullopt : std::optional(airspace.base.z() + map_error)};
}

Obstacles FlightOptions::rules() const {
  Obstacles rules;
  rules.ground_height = airspace.ground_height;
  rules.priors = airspace.priors;
  for (const geometry::Prism& volume : airspace.no_fly) {
    rules.no_fly.push_back(volume);
    rules.no_fly.back().name = std::to_string(rules.no_fly.size());
  }
  if (!airspace.geofence.empty() || airspace.max_height) {
    geometry::Prism fence{.name = "site.geofence", .footprint = airspace.geofence};
    // The floor of the fence must not block the climb from and the descent to the pad.
    if (airspace.max_height) fence.ceiling = *airspace.max_height;
    if (fence.footprint.empty()) {
      fence.name = "site.max_height";
      constexpr double far = 1e5;
      fence.footprint = {{-far, -far}, {far, -far}, {far, far}, {-far, far}};
    }
    rules.fence = fence;
  }
  return rules;
}

double FlightOptions::ground_at(const Eigen::Vector2d& position) const {
  return airspace.ground ? airspace.ground(position) : airspace.base.z();
}

Vector3d FlightOptions::pad(const Vector3d& first_view) const {
  if (takeoff) return *takeoff;
  const AlignedBox3d box = unknown_box;
  const Vector3d margin = Vector3d::Constant(pad_distance_from_unknown(*this));
  const Vector3d low = box.min() - margin, high = box.max() + margin;
  Vector3d pad(first_view.x(), first_view.y(), 0.0);
  pad.z() = ground_at(pad.head<2>());
  if (pad.x() <= low.x() || pad.x() >= high.x() || pad.y() <= low.y() || pad.y() >= high.y()) {
    return pad;
  }
  const double west = pad.x() - low.x(), east = high.x() - pad.x();
  const double south = pad.y() - low.y(), north = high.y() - pad.y();
  const double min = std::min({west, east, south, north});
  if (min == west) {
    pad.x() = low.x();
  } else if (min == east) {
    pad.x() = high.x();
  } else {
    pad.y() = min == south ? low.y() : high.y();
  }
  pad.z() = ground_at(pad.head<2>());
  return pad;
}

double FlightOptions::climb() const {
  return takeoff_climb.value_or(std::max(5.0, clearance + 1.0));
}

double FlightOptions::max_return_altitude(double pad_z, double obstacles_top) const {
  /// Rounding loses up to 1 m, and autopilots may fly level up to 2 m lower. The rest is a surplus,
  /// without which no proof succeeds.
  constexpr double margin = 3.5;
  const double voxel = clearance / voxels_per_clearance;  // unknown space extends to whole voxels
  double top = std::max(obstacles_top, airspace.base.z());
  const auto include = [&](const AlignedBox3d& box) {
    if (!box.isEmpty()) top = std::max(top, voxel * std::ceil(box.max().z() / voxel));
  };
  include(unknown_box);
  std::ranges::for_each(extra_unknown_boxes, include);
  for (const auto& obstacle : airspace.priors) {
    if (!obstacle->extent().isEmpty()) top = std::max(top, obstacle->extent().max().z());
  }
  for (const geometry::Prism& volume : airspace.no_fly) {
    if (volume.ceiling < no_flight_is_higher) top = std::max(top, volume.ceiling);
  }
  const double max_altitude = std::max(top + clearance + margin, pad_z + dji_min_return_altitude);
  if (!airspace.max_height) return max_altitude;
  /// A proof exactly at the fence's clearance would fail because of rounding.
  constexpr double rounding = 0.01;
  return std::min(max_altitude, *airspace.max_height - clearance - rounding);
}

std::vector<AutopilotType> find_autopilots(const Vehicle& vehicle) {
  if (vehicle.autopilot != AutopilotType::dji) return {vehicle.autopilot};
  return {AutopilotType::dji, AutopilotType::px4, AutopilotType::ardupilot};
}

namespace {

/// Returns the rules for fly-through capture with this sensor.
PassRules make_fly_through_rules(const FlightOptions& options) {
  const double distance = options.capture.view_distance;
  PassRules rules{.speed = options.cruise_speed,
                  .max_cut = max_cut_by_distance * distance,
                  .exposure = 0.0,
                  .period = 0.0};
  if (options.capture.scans_in_flight()) return rules;
  if (const std::optional<PhotoShutter>& photo = options.capture.photo) {
    // The trigger's limit is the period, which depends on the distances between the photos.
    const PhotoSpeeds speeds = photo_speeds(*photo, 0.0, options.cruise_speed);
    rules.speed = std::min({speeds.blur, speeds.rolling_shutter, speeds.vehicle});
    rules.exposure = photo->exposure + photo->readout;
    rules.period = photo->min_interval;
    return rules;
  }
  const geometry::Shutter& shutter = options.capture.shutter;
  rules.speed = sharp_speed(options.required_vehicle(), geometry::Camera(options.capture.camera),
                            shutter, distance);
  rules.exposure = shutter.exposure + shutter.readout;
  rules.period = options.capture.frame_period;
  return rules;
}

}  // namespace

RouteOptions FlightOptions::route(const Vector3d& pad) const {
  RouteOptions options;
  options.clearance = budget();
  options.path.max_expansions = max_expansions;
  options.takeoff = pad;
  options.takeoff_climb = climb();
  options.ground_limits = ground_limits();
  options.order_is_free = order == VisitOrder::shortest;
  options.style = style;
  if (style == FlightStyle::pass) options.passing = make_fly_through_rules(*this);
  options.photo = capture.photo;
  // The air moves in the direction opposite to the wind's origin.
  options.conditions.wind = -wind_speed * Eigen::Vector2d(std::sin(wind_from), std::cos(wind_from));
  options.conditions.temperature_c = temperature;
  options.conditions.cruise_speed = cruise_speed;
  options.conditions.reserve = reserve;
  options.conditions.longest_flight = longest_flight(required_vehicle());
  options.returns =
      ReturnOptions{find_autopilots(required_vehicle()), max_return_altitude(pad.z(), pad.z()),
                    rally, braking_before_return()};
  return options;
}

double FlightOptions::braking_before_return() const {
  const Vehicle& flown = required_vehicle();
  // DJI aircraft stop at their maximum acceleration, without a margin for position control.
  return flown.autopilot == AutopilotType::dji ? stopping_distance(flown, {cruise_speed, 0.0, 0.0})
                                               : braking_distance(flown.mode, cruise_speed);
}

double FlightOptions::rest_before() const {
  if (capture.scans_in_flight()) return 0.0;
  const double rest = std::max(hold, capture.settle);
  if (!capture.photo) return rest;
  // Even neighbouring photos are min_interval apart: rest_after(), settling and this rest.
  const double settling = has_vehicle() ? required_vehicle().mode.settle_time : 0.0;
  return std::max(rest, capture.photo->min_interval - rest_after() - settling);
}

double FlightOptions::rest_after() const {
  if (capture.scans_in_flight()) return 0.0;
  if (capture.photo) return std::max(hold_after, capture.photo->exposure + capture.photo->readout);
  const geometry::Shutter& shutter = capture.shutter;
  return std::max(hold_after, shutter.exposure + shutter.readout);
}

std::optional<ImageMotionBounds> FlightOptions::image_motion_bounds() const {
  if (capture.is_scanner) return std::nullopt;
  const geometry::Camera camera(capture.camera);
  return flight::image_motion_bounds(required_vehicle(), camera, capture.shutter,
                                     capture.view_distance);
}

FlightFacts FlightOptions::facts() const {
  FlightFacts facts;
  facts.site = site;
  facts.pad = takeoff.value_or(airspace.base);
  facts.is_pad_known = takeoff.has_value();
  if (has_vehicle()) facts.vehicle = required_vehicle();
  facts.takeoff_climb = climb();
  facts.rally = rally;
  facts.cruise_speed = cruise_speed;
  facts.hold = hold;
  facts.photo = capture.photo;
  Obstacles rules = this->rules();
  facts.no_fly = std::move(rules.no_fly);
  facts.fence = std::move(rules.fence);
  return facts;
}

double FlightOptions::pad_radius() const { return required_vehicle().radius + position_error; }

std::vector<Vector3d> FlightOptions::landings(const Vector3d& pad) const {
  std::vector<Vector3d> landings{pad};
  landings.insert(landings.end(), rally.begin(), rally.end());
  return landings;
}

std::vector<LandingSurface> FlightOptions::landing_surfaces(
    const Vector3d& pad, std::span<const LandingSurface> measured) const {
  const auto by_terrain = [&](const Vector3d& position) -> std::optional<LandingSurface> {
    if (!airspace.terrain) return std::nullopt;
    std::vector<Vector3d> heights;
    for (const Eigen::Vector2d& at : landing_points(position, pad_radius())) {
      if (const auto height = airspace.terrain(at)) heights.emplace_back(at.x(), at.y(), *height);
    }
    return pad_ground(position, heights, GroundSource::terrain);
  };
  std::vector<LandingSurface> landing_surfaces;
  for (const Vector3d& position : landings(pad)) {
    const auto known = std::ranges::find(measured, position, &LandingSurface::position);
    if (known != measured.end()) {
      landing_surfaces.push_back(*known);
    } else if (pad_slope) {
      landing_surfaces.push_back({position, *pad_slope, 0.0, 0.0, GroundSource::declared});
    } else if (const auto ground = by_terrain(position)) {
      landing_surfaces.push_back(*ground);
    }
  }
  return landing_surfaces;
}

PadLimits FlightOptions::ground_limits() const {
  PadLimits limits{max_pad_slope, 0.0};
  for (const auto& obstacle : airspace.priors) {
    if (!obstacle->is_ground()) continue;
    limits.height_error = std::max(limits.height_error, obstacle->uncertainty());
  }
  return limits;
}

}  // namespace skycap::flight
