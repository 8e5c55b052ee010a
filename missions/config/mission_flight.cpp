#include "missions/config/mission_flight.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "flight/space/prior_obstacle.h"
#include "flight/way_home/return_law.h"
#include "missions/config/mission_priors.h"
#include "missions/config/pad_grounds.h"
#include "missions/config/site.h"
#include "missions/config/survey_sensor.h"
#include "missions/config/vehicle_reader.h"

namespace skycap::missions::config {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Voxels of a quarter of the clearance lose little of the free space beside what was measured.
constexpr double voxels_per_clearance = 4.0;

/// How far beside the unknown box places are proposed: more than the clearance and a voxel.
double spare_of(const config::Mission& mission) { return 2.0 * mission.flight.clearance; }

/// The same for pads. Near home DJI's vehicles may land where they are instead of on the pad
/// (ReturnLaw): those columns must not lead into the box, which grows to whole voxels.
double pad_spare_of(const config::Mission& mission) {
  constexpr double voxel_spare = 1.0;
  const bool is_dji =
      mission.flight.is_flown() && vehicle_of(mission).dialect == flight::Dialect::dji;
  const double needed = mission.flight.clearance + flight::dji_lands_at_once + voxel_spare;
  return is_dji ? std::max(spare_of(mission), needed) : spare_of(mission);
}

/// No-fly volumes with their top above this are not flown over [m].
constexpr double no_flight_is_higher = 500.0;

/// What corners are cut by where views are passed, as a share of the view distance.
constexpr double most_cut_by_distance = 0.03;

/// Grid vertices looked at before a view counts as out of reach: some tenths of a second.
constexpr std::size_t most_expansions = 50'000;

}  // namespace

const flight::Vehicle& vehicle_of(const config::Mission& mission) {
  return mission.flight.described;
}

flight::Vehicle stand_in(flight::Dialect dialect) {
  if (dialect == flight::Dialect::px4) return config::find_vehicle("generic");
  return config::find_vehicle(dialect == flight::Dialect::dji ? "m350_rtk" : "generic_ardupilot");
}

flight::Vehicle flown_by(flight::Vehicle vehicle, flight::Dialect dialect) {
  if (vehicle.dialect == dialect) return vehicle;
  const flight::Vehicle other = stand_in(dialect);
  vehicle.dialect = dialect;
  vehicle.mode = other.mode;
  if (dialect == flight::Dialect::dji) vehicle.wpml = other.wpml;
  return vehicle;
}

flight::ClearanceBudget clearance_of(const config::Mission& mission) {
  const config::FlightConfig& config = mission.flight;
  flight::ClearanceBudget budget{.vehicle_radius = vehicle_of(mission).radius,
                                 .position_error = config.position_error,
                                 .tracking_error = config.tracking_error,
                                 .map_error = config.map_error,
                                 .margin = 0.0};
  budget.margin = config.clearance - budget.total();
  return budget;
}

AlignedBox3d unknown_box_of(const config::Mission& mission) {
  return mission.flight.unknown_box ? *mission.flight.unknown_box
                                    : mission.planner.see.scene_box.value_or(AlignedBox3d());
}

std::vector<AlignedBox3d> unknown_beside_of(const config::Mission& mission) {
  const std::vector<Vector3d>& corners = mission.flight.unknown_beside;
  std::vector<AlignedBox3d> boxes;
  for (std::size_t i = 0; i + 1 < corners.size(); i += 2) {
    boxes.emplace_back(corners[i], corners[i + 1]);
  }
  return boxes;
}

bool is_in_known_airspace(const config::Mission& mission, const Vector3d& place) {
  if (!mission.flight.is_flown()) return true;
  const double spare = spare_of(mission);
  return unknown_box_of(mission).exteriorDistance(place) >= spare &&
         std::ranges::all_of(
             unknown_beside_of(mission),
             [&](const AlignedBox3d& box) { return box.exteriorDistance(place) >= spare; }) &&
         std::ranges::all_of(priors_of(mission).obstacles, [&](const auto& obstacle) {
           return obstacle->closest({place, place}, spare).distance >= spare;
         });
}

flight::MeasuredSpaceConfig measured_space_of(const config::Mission& mission) {
  const double voxel = mission.flight.clearance / voxels_per_clearance;
  return {.voxel = voxel,
          .depth_margin = mission.flight.map_error,
          .free_without_return = mission.flight.free_without_return,
          .max_depth = std::min(mission.sensor.camera.camera.max_range, 1e4 * voxel),
          .region = unknown_box_of(mission),
          .beside = unknown_beside_of(mission),
          .floor = priors_of(mission).terrain
                       ? std::nullopt
                       : std::optional(mission.scene.position.z() + mission.flight.map_error)};
}

std::optional<flight::SweepRays> sweep_rays_of(const config::Mission& mission) {
  const sim::LidarConfig& scanner = *mission.sensor.scanner;
  const double speed = mission.flight.cruise_speed;
  const double lever_arm = mission.sensor.mount.value().body_from_scanner.translation().norm();
  switch (kind_of(scanner)) {
    case ScannerKind::ring: {
      // The turn's own cells, a little wider, so that a ray falls into each. Rays begin beside the
      // vehicle's place by the lever arm, half of what it flies in a turn, and what the turns are
      // spread by.
      constexpr double wider = 1.02;
      return flight::SweepRays{.spacing = wider * ray_spacing(scanner),
                               .axis = Vector3d::UnitX(),
                               .origin_spread = lever_arm + 0.5 * spread_of_turns +
                                                0.5 * speed / std::abs(scanner.rotation_rate)};
    }
    case ScannerKind::rosette: {
      // Rays of a pattern that is drawn in flight do not fall between each other as they do at
      // rest, but as if at random: cells of at least four times as many rays.
      constexpr double wider = 2.0;
      const double flown = mission.sensor.is_moving() ? speed * mission.sensor.frame_period : 0.0;
      return flight::SweepRays{.spacing = wider * rosette_of(mission.sensor).gap,
                               .axis = Vector3d::UnitX(),
                               .origin_spread = lever_arm + 0.5 * flown,
                               .is_scattered = true};
    }
    case ScannerKind::line:
      break;
  }
  return std::nullopt;
}

flight::Obstacles flight_rules(const config::Mission& mission) {
  flight::Obstacles rules;
  rules.ground_height = ground_height_of(mission);
  rules.priors = priors_of(mission).obstacles;
  const config::SiteConfig& site = mission.site;
  for (const geometry::Prism& volume : site.no_fly) {
    rules.no_fly.push_back(volume);
    rules.no_fly.back().name = std::to_string(rules.no_fly.size());
  }
  if (!site.geofence.empty() || site.highest_height) {
    geometry::Prism fence{.name = "site.geofence", .footprint = site.geofence};
    // The fence must not hold the vehicle up on its way from and to the pad.
    if (site.highest_height) fence.ceiling = *site.highest_height;
    if (fence.footprint.empty()) {
      fence.name = "site.highest_height";
      constexpr double far = 1e5;
      fence.footprint = {{-far, -far}, {far, -far}, {far, far}, {-far, far}};
    }
    rules.fence = fence;
  }
  return rules;
}

Vector3d pad_of(const config::Mission& mission, const Vector3d& first_view) {
  if (mission.flight.takeoff) return *mission.flight.takeoff;
  const AlignedBox3d box = unknown_box_of(mission);
  const Vector3d spare = Vector3d::Constant(pad_spare_of(mission));
  const Vector3d low = box.min() - spare, high = box.max() + spare;
  Vector3d pad(first_view.x(), first_view.y(), 0.0);
  pad.z() = ground_at(mission, pad.head<2>());
  if (pad.x() <= low.x() || pad.x() >= high.x() || pad.y() <= low.y() || pad.y() >= high.y()) {
    return pad;
  }
  const double west = pad.x() - low.x(), east = high.x() - pad.x();
  const double south = pad.y() - low.y(), north = high.y() - pad.y();
  const double least = std::min({west, east, south, north});
  if (least == west) {
    pad.x() = low.x();
  } else if (least == east) {
    pad.x() = high.x();
  } else {
    pad.y() = least == south ? low.y() : high.y();
  }
  pad.z() = ground_at(mission, pad.head<2>());
  return pad;
}

double takeoff_climb_of(const config::Mission& mission) {
  return mission.flight.takeoff_climb.value_or(std::max(5.0, mission.flight.clearance + 1.0));
}

double highest_return(const config::Mission& mission, double pad_z, double obstacles_top) {
  /// A whole metre is lost in rounding, and autopilots may fly level up to 2 m lower.
  constexpr double spare = 3.0;
  const AlignedBox3d box = unknown_box_of(mission);
  double top = std::max(obstacles_top, mission.scene.position.z());
  if (!box.isEmpty()) top = std::max(top, box.max().z());
  for (const auto& obstacle : priors_of(mission).obstacles) {
    if (!obstacle->extent().isEmpty()) top = std::max(top, obstacle->extent().max().z());
  }
  for (const geometry::Prism& volume : mission.site.no_fly) {
    if (volume.ceiling < no_flight_is_higher) top = std::max(top, volume.ceiling);
  }
  const double highest =
      std::max(top + mission.flight.clearance + spare, pad_z + flight::least_of_dji);
  if (!mission.site.highest_height) return highest;
  /// A proof right at the fence's clearance fails by rounding.
  constexpr double rounding = 0.01;
  return std::min(highest, *mission.site.highest_height - mission.flight.clearance - rounding);
}

std::vector<flight::Dialect> dialects_of(const flight::Vehicle& vehicle) {
  if (vehicle.dialect != flight::Dialect::dji) return {vehicle.dialect};
  return {flight::Dialect::dji, flight::Dialect::px4, flight::Dialect::ardupilot};
}

namespace {

/// What its pictures ask of a flight that passes its views.
flight::PassRules pass_rules_of(const config::Mission& mission) {
  const double distance = view_distance_of(mission);
  flight::PassRules rules{.speed = mission.flight.cruise_speed,
                          .most_cut = most_cut_by_distance * distance,
                          .exposure = 0.0,
                          .period = 0.0};
  if (scans_in_flight(mission)) return rules;
  const flight::Shutter& shutter = mission.sensor.shutter;
  rules.speed = flight::sharp_speed(
      vehicle_of(mission), geometry::Camera(mission.sensor.camera.camera), shutter, distance);
  rules.exposure = shutter.exposure + shutter.readout;
  rules.period = mission.sensor.frame_period;
  return rules;
}

}  // namespace

flight::RouteOptions route_options_of(const config::Mission& mission, const Vector3d& pad) {
  const config::FlightConfig& config = mission.flight;
  flight::RouteOptions options;
  options.clearance = clearance_of(mission);
  options.path.max_expansions = most_expansions;
  options.takeoff = pad;
  options.takeoff_climb = takeoff_climb_of(mission);
  options.ground_limits = ground_limits_of(mission);
  options.order_is_free = config.order == config::VisitOrder::shortest;
  options.style = config.style;
  if (config.style == flight::FlightStyle::pass) options.passing = pass_rules_of(mission);
  // The air moves away from where the wind comes from.
  options.conditions.wind =
      -config.wind_speed * Eigen::Vector2d(std::sin(config.wind_from), std::cos(config.wind_from));
  options.conditions.temperature_c = config.temperature;
  options.conditions.cruise_speed = config.cruise_speed;
  options.conditions.reserve = config.reserve;
  options.returns = flight::ReturnOptions{dialects_of(vehicle_of(mission)),
                                          highest_return(mission, pad.z(), pad.z()), config.rally};
  return options;
}

bool scans_in_flight(const config::Mission& mission) {
  return mission.sensor.mount && mission.sensor.is_moving();
}

double hold_of(const config::Mission& mission) {
  if (scans_in_flight(mission)) return 0.0;
  return std::max(mission.flight.hold, mission.sensor.settle);
}

double hold_after_of(const config::Mission& mission) {
  if (scans_in_flight(mission)) return 0.0;
  const flight::Shutter& shutter = mission.sensor.shutter;
  return std::max(mission.flight.hold_after, shutter.exposure + shutter.readout);
}

std::optional<flight::PictureBounds> picture_bounds_of(const config::Mission& mission) {
  if (mission.sensor.lidar) return std::nullopt;
  const geometry::Camera camera(mission.sensor.camera.camera);
  return picture_bounds(vehicle_of(mission), camera, mission.sensor.shutter,
                        view_distance_of(mission));
}

bool has_place(const config::Mission& mission) {
  return mission.georeference.latitude_deg && mission.georeference.longitude_deg;
}

flight::Site site_of(const config::Mission& mission) {
  const config::Georeference& place = mission.georeference;
  flight::Site site;
  site.origin = {place.latitude_deg.value_or(0.0), place.longitude_deg.value_or(0.0),
                 place.ellipsoid_height};
  site.geoid_undulation = place.geoid_undulation;
  return site;
}

flight::FlightFacts flight_facts(const config::Mission& mission) {
  flight::FlightFacts facts;
  facts.site = site_of(mission);
  facts.pad = mission.flight.takeoff.value_or(mission.scene.position);
  facts.is_pad_known = mission.flight.takeoff.has_value();
  if (mission.flight.is_flown()) facts.vehicle = vehicle_of(mission);
  facts.takeoff_climb = takeoff_climb_of(mission);
  facts.rally = mission.flight.rally;
  facts.cruise_speed = mission.flight.cruise_speed;
  facts.hold = mission.flight.hold;
  flight::Obstacles rules = flight_rules(mission);
  facts.no_fly = std::move(rules.no_fly);
  facts.fence = std::move(rules.fence);
  return facts;
}

}  // namespace skycap::missions::config
