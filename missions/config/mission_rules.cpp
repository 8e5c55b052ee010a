#include "missions/config/mission_rules.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "geometry/error.h"
#include "missions/config/mission_flight.h"
#include "missions/config/mission_keys.h"
#include "missions/config/mission_priors.h"
#include "missions/config/planner_factory.h"
#include "missions/config/planner_titles.h"
#include "missions/config/site.h"
#include "missions/support/number_text.h"
#include "sim/models/models.h"

namespace skycap::missions::config {
namespace {

using support::short_text;

/// What planners call a setting, after "planner." or not, and the key that gives it. The others are
/// called by their key, or by its end, in the section planner.
struct SettingKey {
  std::string_view setting, key;
};

constexpr std::array<SettingKey, 13> setting_keys{{
    {"coverage_radius", "evaluation.registration_distance"},
    {"stop.wanted_coverage", "planner.wanted_coverage"},
    {"stop.least_gain", "planner.least_gain"},
    {"stop.most_length", "limits.max_distance"},
    {"stop.most_time", "limits.max_minutes"},
    {"stop.speed", "limits.speed"},
    {"stop.time_per_view", "limits.time_per_view"},
    {"scene_box", "planner.scene_box.max"},
    {"stand_off", "limits.stand_off"},
    {"least_height", "site.highest_height"},
    {"least_pitch", "limits.highest_pitch_deg"},
    {"geofence", "site.geofence"},
    {"no_fly", "site.no_fly"},
}};

std::string key_of(std::string_view setting) {
  constexpr std::string_view section = "planner.";
  if (config::find_key(setting)) return std::string(setting);
  if (setting.starts_with(section)) setting.remove_prefix(section.size());
  const auto known = std::ranges::find(setting_keys, setting, &SettingKey::setting);
  return known == setting_keys.end() ? std::string(section).append(setting)
                                     : std::string(known->key);
}

void check_builtin(const config::MissionFile& given, std::string_view name) {
  const auto models = sim::builtin_models();
  if (std::ranges::find(models, name) != models.end()) return;
  std::string known;
  for (const std::string_view model : models) {
    known += (known.empty() ? "builtin:" : ", builtin:") + std::string(model);
  }
  given.refuse("scene.model", "is " + given.mission.scene.model + "; there are " + known);
}

void check_views(const config::MissionFile& given) {
  const config::Mission& mission = given.mission;
  if (mission.flight.views != config::MissionViews::anew) return;
  if (mission.planner.name != config::PlannerName::skycap) {
    given.refuse("flight.views",
                 "is anew, and the planner " +
                     std::string(config::title_of(mission.planner.name).word) +
                     " keeps no surface that views could be chosen by; plan with planner.name "
                     "skycap or leave it out");
  }
  if (mission.flight.order == config::VisitOrder::survey) {
    given.refuse("flight.views",
                 "is anew, and such views have no order of the survey; leave out flight.order or "
                 "flight.views");
  }
}

void check_capture(const config::MissionFile& given) {
  const config::Mission& mission = given.mission;
  if (!mission.sensor.is_moving()) {
    if (!given.gives("sensor.frame_period")) return;
    given.refuse("sensor.frame_period",
                 "is for frames on the way, which sensor.capture moving takes; leave it out");
  }
  const char* const wants = "is moving; it needs ";
  if (!mission.flight.is_flown()) {
    given.refuse("sensor.capture", std::string(wants) + "a vehicle, give flight.vehicle");
  }
  if (mission.planner.name != config::PlannerName::skycap) {
    given.refuse("sensor.capture",
                 std::string(wants) +
                     "a planner that learns from more than its own views, planner.name skycap");
  }
}

}  // namespace

void check_scene(const config::MissionFile& given) {
  const config::Mission& mission = given.mission;
  const config::SceneConfig& scene = mission.scene;
  if (mission.name.find('/') != std::string::npos || mission.name.starts_with('.')) {
    given.refuse("name",
                 "is " + mission.name + "; it names a folder, give it without '/' and leading '.'");
  }
  constexpr std::string_view builtin = "builtin:";
  if (scene.model.starts_with(builtin)) check_builtin(given, scene.model.substr(builtin.size()));
  if (given.gives("scene.detail") && !scene.model.starts_with("builtin:")) {
    given.refuse("scene.detail",
                 "needs a builtin model; " + scene.model + " is as detailed as its file");
  }
  if (scene.longest_side && scene.scale) {
    given.refuse("scene.scale", "excludes scene.longest_side; keep one of the two");
  }
  const auto& box = mission.planner.see.scene_box;
  if (scene.ground && !box && !has_target(mission)) {
    given.refuse("scene.ground",
                 "needs planner.scene_box, or the plan would cover the ground too; give the box's "
                 "min and max");
  }
  if (scene.neighbours && !has_obstacle(mission)) {
    given.refuse("scene.neighbours",
                 "needs a file of prior data whose role is obstacle, which holds them");
  }
  if (box && !(box->min().array() < box->max().array()).all()) {
    given.refuse("planner.scene_box.max",
                 "is not above planner.scene_box.min on every axis; swap or widen the corners");
  }
}

void check_live(const config::MissionFile& given) {
  if (!given.mission.planner.see.scene_box && !has_target(given.mission)) {
    given.refuse("planner.scene_box.min",
                 "is missing; without scene.model the mission is live, and has to say with "
                 "planner.scene_box where the scene is: give the box's min and max");
  }
  if (given.mission.flight.is_flown() && !given.mission.start.position) {
    given.refuse("start.position",
                 "is missing; a live mission with a vehicle has to say where its first view is, so "
                 "that the way there can be proven");
  }
}

void check_start(const config::MissionFile& given) {
  const config::StartConfig& start = given.mission.start;
  if (!start.position && (start.look_at || start.direction)) {
    given.refuse(start.look_at ? "start.look_at" : "start.direction",
                 "needs start.position; give it, or leave both out for a random start");
  }
  if (start.position && start.look_at.has_value() == start.direction.has_value()) {
    given.refuse("start.position", "needs either start.look_at or start.direction");
  }
  if (start.direction && start.direction->norm() < 1e-6) {
    given.refuse("start.direction", "has no length; give a vector that has");
  }
  if (start.look_at && (*start.look_at - *start.position).norm() < 1e-6) {
    given.refuse("start.look_at", "is the start's position; give another point");
  }
}

void check_sensor(const config::MissionFile& given) {
  const geometry::CameraConfig& camera = given.mission.sensor.camera.camera;
  if (camera.max_range <= camera.min_range) {
    given.refuse("sensor.max_range", "is not above sensor.min_range; make it larger");
  }
  if (static_cast<double>(camera.width) * camera.height > 1e8) {
    given.refuse("sensor.width",
                 "times sensor.height is more than 1e8 pixels; make the image smaller");
  }
  check_capture(given);
}

void check_boxes_beside(const config::MissionFile& given) {
  const std::vector<Eigen::Vector3d>& corners = given.mission.flight.unknown_beside;
  if (corners.size() % 2 != 0) {
    given.refuse("flight.unknown_beside",
                 "has " + std::to_string(corners.size()) +
                     " corners; give the lower and the upper one of each box");
  }
  for (std::size_t i = 0; i < corners.size(); i += 2) {
    if ((corners[i].array() < corners[i + 1].array()).all()) continue;
    given.refuse("flight.unknown_beside",
                 "has an upper corner that is not above its lower one on every axis; swap or "
                 "widen the corners");
  }
}

void check_flight(const config::MissionFile& given) {
  const config::Mission& mission = given.mission;
  const config::Georeference& place = mission.georeference;
  if (place.latitude_deg.has_value() != place.longitude_deg.has_value()) {
    given.refuse(place.latitude_deg ? "site.latitude_deg" : "site.longitude_deg",
                 "is half a place; give site.latitude_deg and site.longitude_deg");
  }
  const config::FlightConfig& flight = mission.flight;
  if (!flight.is_flown()) return;
  if (const auto& box = flight.unknown_box;
      box && !(box->min().array() < box->max().array()).all()) {
    given.refuse("flight.unknown_box.max",
                 "is not above flight.unknown_box.min on every axis; swap or widen the corners");
  }
  check_boxes_beside(given);
  if (unknown_box_of(mission).isEmpty()) {
    given.refuse("flight.vehicle",
                 "needs flight.unknown_box, around the building: in it nothing is free until "
                 "measured; give the box's min and max");
  }
  const flight::ClearanceBudget budget = clearance_of(mission);
  if (budget.margin < 0.0) {
    given.refuse("flight.clearance",
                 "is less than the vehicle's radius of " + short_text(budget.vehicle_radius) +
                     " m and the position, tracking and map errors make together, " +
                     short_text(budget.total() - budget.margin) +
                     " m; make it larger or the errors smaller");
  }
  check_views(given);
  if (flight.style == flight::FlightStyle::pass && mission.sensor.settle > 0.0) {
    given.refuse("flight.style",
                 "takes pictures without a stop, but the sensor has to rest before each "
                 "(sensor.settle); choose stop, blend or smooth");
  }
  if (const double climb = takeoff_climb_of(mission); climb <= flight.clearance) {
    given.refuse("flight.takeoff_climb",
                 "of " + short_text(climb) +
                     " m ends within the clearance of the ground; make it more than "
                     "flight.clearance");
  }
  if (!flight.rally.empty() && vehicle_of(mission).dialect == flight::Dialect::dji) {
    given.refuse("flight.rally", "is not for " + flight.vehicle +
                                     ": DJI's vehicles return to their pad only; leave it out");
  }
  if (const double sigma = mission.sensor.camera.noise.sigma; flight.map_error < 3.0 * sigma) {
    given.refuse("flight.map_error",
                 "is below three standard deviations of the sensor's noise; make it at least " +
                     short_text(3.0 * sigma) + " m");
  }
  if (const double most = vehicle_of(mission).max_wind; flight.wind_speed >= most) {
    given.refuse("flight.wind_speed", "is not below the " + short_text(most) + " m/s that " +
                                          flight.vehicle + " is made for");
  }
}

void check_view_limits(const config::MissionFile& given) {
  const survey::ViewLimits limits = view_limits(given.mission);
  if (limits.least_height && limits.most_height && *limits.least_height >= *limits.most_height) {
    given.refuse("site.highest_height",
                 "is not above site.lowest_height and limits.ground_clearance; nothing is left to "
                 "fly in");
  }
  if (limits.least_pitch >= limits.most_pitch) {
    given.refuse("limits.highest_pitch_deg", "is not above limits.lowest_pitch_deg; raise it");
  }
}

void check_planner(const config::MissionFile& given) {
  try {
    validate_planner(given.mission);
  } catch (const Error& error) {
    // "SETTING is 3; it must be ...", or a sentence about several settings.
    const std::string_view message = error.what();
    const std::string_view setting = message.substr(0, message.find(' '));
    const std::string key = key_of(setting);
    if (!config::find_key(key)) given.refuse("planner", std::string(message));
    given.refuse(key, std::string(message.substr(std::min(setting.size() + 1, message.size()))));
  }
}

}  // namespace skycap::missions::config
