#include "missions/config/mission_rules.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "geometry/error.h"
#include "missions/config/derived_values.h"
#include "missions/config/field_keys.h"
#include "missions/config/mission_keys.h"
#include "missions/support/number_text.h"
#include "sim/models/models.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::config {
namespace {

using support::short_text;

void check_builtin(const MissionDocument& document, std::string_view name) {
  const auto models = sim::builtin_models();
  if (std::ranges::find(models, name) != models.end()) return;
  std::string known;
  for (const std::string_view model : models) {
    known += (known.empty() ? "builtin:" : ", builtin:") + std::string(model);
  }
  document.reject("scene.model",
                  "unknown model " + document.scene.model + "; expected one of: " + known);
}

void check_views(const MissionDocument& document) {
  if (document.flight.options.views != flight::MissionViews::replanned) return;
  if (document.planner.name != survey::PlannerName::skycap) {
    document.reject("flight.views",
                    "replanned requires the planner skycap; the planner " +
                        std::string(survey::find_title(document.planner.name).word) +
                        " keeps no surface model. Set planner.name: skycap or remove flight.views");
  }
  if (document.flight.options.order == flight::VisitOrder::survey) {
    document.reject("flight.views",
                    "replanned conflicts with flight.order: survey; remove one of the two");
  }
}

void check_capture(const MissionDocument& document) {
  if (!document.sensor.options.is_moving()) {
    if (!document.has("sensor.frame_period")) return;
    document.reject("sensor.frame_period",
                    "requires sensor.capture: moving (en-route frames); remove it");
  }
  const char* const wants = "moving requires ";
  if (!document.flight.has_vehicle()) {
    document.reject("sensor.capture", std::string(wants) + "a vehicle; set flight.vehicle");
  }
  if (document.planner.name != survey::PlannerName::skycap &&
      !survey::pattern_of(document.planner.name)) {
    document.reject("sensor.capture",
                    std::string(wants) +
                        "a planner that uses en-route frames; set planner.name: skycap, or a "
                        "pattern");
  }
}

/// Keys that require several vehicles.
constexpr const char* fleet_only_keys[] = {"flight.pads", "flight.fleet_goal", "flight.separation",
                                           "flight.timing_tolerance"};

/// Returns the minimum separation [m]: the radii of the two largest vehicles plus twice the
/// position and tracking errors.
double min_separation(const flight::FlightOptions& flight) {
  std::vector<double> radii;
  for (const flight::Vehicle& vehicle : flight.fleet.vehicles) radii.push_back(vehicle.radius);
  std::ranges::sort(radii, std::greater());
  return radii[0] + radii[1] + 2.0 * (flight.position_error + flight.tracking_error);
}

void check_required_pads(const MissionDocument& document) {
  const flight::FlightOptions& flight = document.flight.options;
  const std::vector<Eigen::Vector3d>& pads = flight.fleet.pads;
  if (pads.empty()) return;
  if (pads.size() != flight.fleet.names.size()) {
    document.reject("flight.pads", "has " + std::to_string(pads.size()) + " take-off points for " +
                                       std::to_string(flight.fleet.names.size()) +
                                       " vehicles in flight.vehicles; list one point per vehicle");
  }
  if (flight.takeoff && *flight.takeoff != pads.front()) {
    document.reject("flight.takeoff", "must be the first position in flight.pads; remove it");
  }
}

}  // namespace

void check_scene(const MissionDocument& document) {
  const scene::SceneOptions& scene = document.scene;
  if (document.name.find('/') != std::string::npos || document.name.starts_with('.')) {
    document.reject("name",
                    "invalid name " + document.name +
                        "; it is used as a folder name and must not contain '/' or begin with '.'");
  }
  constexpr std::string_view builtin = "builtin:";
  if (scene.model.starts_with(builtin)) check_builtin(document, scene.model.substr(builtin.size()));
  if (document.has("scene.detail") && !scene.model.starts_with("builtin:")) {
    document.reject("scene.detail",
                    "requires a builtin model; " + scene.model + " has a fixed level of detail");
  }
  if (scene.longest_side && scene.scale) {
    document.reject("scene.scale", "conflicts with scene.longest_side; remove one of the two");
  }
  const auto& box = document.planner.sampling.scene_box;
  if (scene.ground && !box && !has_target(document)) {
    document.reject(
        "scene.ground",
        "requires planner.scene_box, which keeps the ground out of the plan; set its min and max");
  }
  if (scene.neighbours && !has_obstacle(document)) {
    document.reject("scene.neighbours", "requires prior data with role: obstacle");
  }
  if (box && !(box->min().array() < box->max().array()).all()) {
    document.reject(
        "planner.scene_box.max",
        "must be greater than planner.scene_box.min on every axis; swap or widen the corners");
  }
}

void check_density(const MissionDocument& document) {
  const SamplingSection& sampling = document.planner.sampling;
  if (!sampling.density_per_m2) return;
  const char* const key = "planner.density_per_m2";
  if (survey::find_title(document.planner.name).metric) {
    document.reject(key, "requires the planner skycap, see++ or see; the planner " +
                             std::string(survey::find_title(document.planner.name).word) +
                             " plans for voxels. Set planner.name: skycap or remove the key");
  }
  // A completed mission sets both keys, with consistent values.
  const double density = compute_volume_density(document);
  if (std::abs(sampling.density - density) > 1e-6 * density) {
    document.reject("planner.density",
                    "conflicts with planner.density_per_m2; remove one of the two");
  }
  const double max_spacing = compute_density_distance(document);
  if (compute_spacing(document) > max_spacing) {
    document.reject("planner.spacing", "must be at most " + short_text(max_spacing) + " m for " +
                                           short_text(*sampling.density_per_m2) +
                                           " points per square metre; lower it or remove it");
  }
}

void check_live(const MissionDocument& document) {
  if (!document.planner.sampling.scene_box && !has_target(document)) {
    document.reject("planner.scene_box.min",
                    "is missing: without scene.model the mission is a live survey and requires "
                    "planner.scene_box; set its min and max");
  }
  if (document.flight.has_vehicle() && !document.start.position) {
    document.reject("start.position",
                    "is missing: a live survey with a vehicle requires the position of its first "
                    "view, to verify the path to it");
  }
}

void check_start(const MissionDocument& document) {
  const StartSection& start = document.start;
  if (!start.position && (start.look_at || start.direction)) {
    document.reject(start.look_at ? "start.look_at" : "start.direction",
                    "requires start.position; set it, or remove both for a random start");
  }
  if (start.position && start.look_at.has_value() == start.direction.has_value()) {
    document.reject("start.position", "requires either start.look_at or start.direction");
  }
  if (start.direction && start.direction->norm() < 1e-6) {
    document.reject("start.direction", "must not have zero length");
  }
  if (start.look_at && (*start.look_at - *start.position).norm() < 1e-6) {
    document.reject("start.look_at", "must differ from start.position");
  }
}

void check_sensor(const MissionDocument& document) {
  const geometry::CameraConfig& camera = document.sensor.options.camera.camera;
  if (camera.max_range <= camera.min_range) {
    document.reject("sensor.max_range", "must be greater than sensor.min_range; raise it");
  }
  if (static_cast<double>(camera.width) * camera.height > 1e8) {
    document.reject("sensor.width",
                    "the image has more than 100 million pixels (sensor.width times "
                    "sensor.height); reduce its size");
  }
  check_capture(document);
}

void check_extra_unknown_boxes(const MissionDocument& document) {
  const std::vector<Eigen::Vector3d>& corners = document.flight.extra_unknown_boxes;
  if (corners.size() % 2 != 0) {
    document.reject("flight.extra_unknown_boxes",
                    "has " + std::to_string(corners.size()) +
                        " corners; list the lower and the upper corner of each box");
  }
  for (std::size_t i = 0; i < corners.size(); i += 2) {
    if ((corners[i].array() < corners[i + 1].array()).all()) continue;
    document.reject("flight.extra_unknown_boxes",
                    "an upper corner must be greater than its lower corner on every axis; swap or "
                    "widen the corners");
  }
}

void check_flight(const MissionDocument& document) {
  const Georeference& georeference = document.georeference;
  if (georeference.latitude_deg.has_value() != georeference.longitude_deg.has_value()) {
    document.reject(georeference.latitude_deg ? "site.latitude_deg" : "site.longitude_deg",
                    "incomplete georeference; set both site.latitude_deg and site.longitude_deg");
  }
  if (!document.flight.has_vehicle()) return;
  const flight::FlightOptions flight = flight_options(document);
  if (const auto& box = document.flight.unknown_box;
      box && !(box->min().array() < box->max().array()).all()) {
    document.reject(
        "flight.unknown_box.max",
        "must be greater than flight.unknown_box.min on every axis; swap or widen the corners");
  }
  check_extra_unknown_boxes(document);
  if (flight.unknown_box.isEmpty() && !document.is_inspection()) {
    document.reject(
        "flight.vehicle",
        "requires flight.unknown_box around the building, in which unknown space counts "
        "as occupied; set its min and max");
  }
  const flight::ClearanceBudget budget = flight.budget();
  if (budget.margin < 0.0) {
    document.reject("flight.clearance", "must be at least the sum of the vehicle's radius (" +
                                            short_text(budget.vehicle_radius) +
                                            " m) and the position, tracking and map errors: " +
                                            short_text(budget.total() - budget.margin) +
                                            " m; raise it or lower the errors");
  }
  const flight::Vehicle& vehicle = flight.required_vehicle();
  const double overshoot = flight::stop_overshoot(vehicle);
  if (budget.margin < overshoot) {
    document.reject(
        "flight.clearance",
        "must be at least " +
            short_text(std::ceil(100.0 * (budget.total() - budget.margin + overshoot)) / 100.0) +
            " m, because a return of ArduCopter that begins shortly before a stop passes it by up "
            "to " +
            short_text(std::ceil(100.0 * overshoot) / 100.0) + " m; raise it");
  }
  check_views(document);
  if (flight.style == flight::FlightStyle::pass && document.sensor.options.settle > 0.0) {
    document.reject("flight.style",
                    "fly-through conflicts with a sensor that must be at rest before each capture "
                    "(sensor.settle); choose stop, blend or smooth");
  }
  if (const double climb = flight.climb(); climb <= flight.clearance) {
    document.reject(
        "flight.takeoff_climb",
        "a climb of " + short_text(climb) +
            " m ends within the clearance of the ground; it must be greater than flight.clearance");
  }
  if (!flight.rally.empty() && flight.required_vehicle().autopilot == flight::AutopilotType::dji) {
    document.reject("flight.rally",
                    "conflicts with flight.vehicle " + flight.vehicle_name +
                        ": DJI vehicles return to their take-off point only; remove it");
  }
  if (const double sigma = document.sensor.options.camera.noise.sigma;
      flight.map_error < 3.0 * sigma * (1.0 - 1e-12)) {  // 3 x 0.05 is above 0.15
    document.reject("flight.map_error",
                    "must be at least three standard deviations of the sensor noise: " +
                        short_text(3.0 * sigma) + " m; raise it, or lower sensor.noise.sigma");
  }
  if (const double max = vehicle.max_speed; flight.cruise_speed > max) {
    document.reject("flight.cruise_speed", "must be at most " + short_text(max) +
                                               " m/s, the maximum speed of " + flight.vehicle_name +
                                               "; lower it");
  }
  if (const double max = flight.required_vehicle().max_wind; flight.wind_speed >= max) {
    document.reject("flight.wind_speed", "must be less than the maximum wind of " +
                                             short_text(max) + " m/s that " + flight.vehicle_name +
                                             " allows");
  }
}

void lead_fleet(MissionDocument& document) {
  flight::FlightOptions& flight = document.flight.options;
  flight::FleetOptions& fleet = flight.fleet;
  if (fleet.names.empty()) {
    // A resolved fleet of one vehicle is a single vehicle.
    if (document.has("flight.vehicles") && document.flight.has_vehicle()) {
      if (!fleet.pads.empty()) {
        document.reject("flight.pads", "requires flight.vehicles");
      }
      if (!flight.vehicle && !fleet.vehicles.empty()) flight.vehicle = fleet.vehicles.front();
      fleet = {};
      return;
    }
    for (const char* key : fleet_only_keys) {
      if (document.has(key)) document.reject(key, "requires flight.vehicles");
    }
    return;
  }
  if (document.flight.has_vehicle() && flight.vehicle_name != fleet.names.front()) {
    document.reject("flight.vehicle", "must be the first vehicle in flight.vehicles; remove it");
  }
  check_required_pads(document);
  flight.vehicle_name = fleet.names.front();
  flight.vehicle = fleet.vehicles.front();
  if (!fleet.pads.empty()) flight.takeoff = fleet.pads.front();
  if (fleet.names.size() == 1) fleet = {};
}

void check_fleet(const MissionDocument& document) {
  if (!document.flight.options.is_fleet()) return;
  if (!is_georeferenced(document)) {
    document.reject(
        "flight.vehicles",
        "requires a georeference, because the separation is verified on the route files; "
        "set site.latitude_deg and site.longitude_deg");
  }
  const flight::FlightOptions& flight = document.flight.options;
  if (flight.style != flight::FlightStyle::stop) {
    document.reject(
        "flight.style",
        "conflicts with flight.vehicles: the separation is verified only for flights with "
        "stops; remove it");
  }
  if (const double min = min_separation(flight); flight.fleet.separation < min) {
    document.reject(
        "flight.separation",
        "must be at least the sum of both vehicles' radii, position errors and tracking errors: " +
            support::short_text(min) + " m; raise it");
  }
  for (std::size_t v = 1; v < flight.fleet.names.size(); ++v) {
    MissionDocument own = document;
    own.flight.options = flight.for_vehicle(v, flight.takeoff.value_or(Eigen::Vector3d::Zero()));
    check_flight(own);
  }
}

void check_view_limits(const MissionDocument& document) {
  const survey::ViewLimits limits = view_limits(document);
  if (limits.min_height && limits.max_height && *limits.min_height >= *limits.max_height) {
    document.reject(
        "site.max_height",
        "must be greater than site.min_height and limits.ground_clearance; otherwise no "
        "airspace is left");
  }
  if (limits.min_pitch >= limits.max_pitch) {
    document.reject("limits.max_pitch_deg", "must be greater than limits.min_pitch_deg; raise it");
  }
}

namespace {

/// Throws if the candidates' sphere is entirely below the minimum height. Applies only if both
/// sphere keys are set.
void validate_sphere(const survey::volumetric::VolumetricConfig& config) {
  const survey::volumetric::VolumetricSettings& settings = config.settings;
  if (!settings.sphere_centre || !settings.sphere_radius || !config.min_height) return;
  const double max_height = config.sphere_centre.z() + config.sphere_radius;
  if (max_height > *config.min_height) return;
  throw Error(ErrorKind::bad_config, "sphere_radius is " + short_text(config.sphere_radius) +
                                         "; the sphere must reach above the minimum height of " +
                                         short_text(*config.min_height) +
                                         " m (limits.ground_clearance)");
}

}  // namespace

namespace {

/// Replaces field names in a message by mission keys. Only words with an underscore are treated as
/// field names.
std::string in_keys(std::string_view message) {
  const auto is_name_char = [](char c) { return c == '_' || c == '.' || (c >= 'a' && c <= 'z'); };
  std::string text;
  while (!message.empty()) {
    const auto end = std::ranges::find_if_not(message, is_name_char);
    const std::string_view word(message.begin(), end);
    const bool is_name = word.find('_') != std::string_view::npos;
    const std::string_view key = is_name ? find_field_key(word) : std::string_view();
    text += key.empty() ? word : key;
    const std::size_t rest = std::min(message.size(), std::max<std::size_t>(word.size(), 1));
    if (word.empty()) text += message.front();
    message.remove_prefix(rest);
  }
  return text;
}

}  // namespace

namespace {

void check_pattern(const MissionDocument& document) {
  const survey::patterns::PatternSettings& settings = document.planner.patterns;
  const bool has_polygon = !settings.polygon.empty(), has_line = !settings.line.empty();
  if (has_polygon && has_line) {
    document.reject("pattern.line", "conflicts with pattern.polygon; remove one of the two");
  }
  if ((has_polygon || has_line) && !settings.top) {
    document.reject("pattern.top",
                    "is missing; set the z of the target's top in the mission frame [m]");
  }
  if (settings.top && !has_polygon && !has_line) {
    document.reject("pattern.top", "requires pattern.polygon or pattern.line");
  }
  const double base = settings.base.value_or(compute_ground_height(document));
  if (settings.top && *settings.top < base) {
    document.reject("pattern.top", "must be at least the z of the base (" + short_text(base) +
                                       " m); raise it or lower pattern.base");
  }
  if (has_line && survey::patterns::length_of(settings.line) < 1e-6) {
    document.reject("pattern.line", "must contain two different points");
  }
  if (has_polygon && survey::patterns::area_of(settings.polygon) < 1e-6) {
    document.reject("pattern.polygon", "must not have zero area; check its corners");
  }
  if (!survey::pattern_of(document.planner.name)) return;
  const bool is_simulated = !document.scene.model.empty() || document.scene.truth;
  if (!has_polygon && !has_line && !has_target(document) && !is_simulated) {
    document.reject("planner.name",
                    "a pattern requires a target; add prior data with role: target, or set "
                    "pattern.polygon or pattern.line with pattern.top");
  }
}

}  // namespace

void check_planner(const MissionDocument& document) {
  check_pattern(document);
  if (document.planner.name == survey::PlannerName::external && !document.planner.file) {
    document.reject("planner.file",
                    "is missing; the planner external requires a shared library (.so) or a Python "
                    "file (.py)");
  }
  try {
    const survey::PlannerOptions planner = planner_options(document, flight_options(document));
    planner.validate();
    if (const auto* volumetric =
            std::get_if<survey::volumetric::VolumetricConfig>(&planner.method)) {
      validate_sphere(*volumetric);
    }
  } catch (const Error& error) {
    // Message: "FIELD is 3; it must be ...", or a sentence about several fields.
    const std::string_view message = error.what();
    const std::string_view field = message.substr(0, message.find(' '));
    const std::string_view key = find_field_key(field);
    if (key.empty()) document.reject("planner", in_keys(message));
    document.reject(key, in_keys(message.substr(std::min(field.size() + 1, message.size()))));
  }
}

}  // namespace skycap::missions::config
