#include "missions/file/mission_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

#include "geometry/error.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/site.h"
#include "missions/derived/survey_sensor.h"
#include "missions/file/mission_keys.h"
#include "missions/file/number_text.h"
#include "missions/file/unknown_key.h"
#include "missions/file/yaml_tree.h"

namespace skycap::missions::file {
namespace {

constexpr std::size_t largest_file = 1 << 20;  // [byte]; a mission has a few thousand

/// A value and where it stands.
struct Given {
  std::string place;  ///< "FILE:LINE" or an option's name
  YamlNode node;
};

/// The values of a mission by key, checked to be known but not yet read.
using GivenValues = std::map<std::string, Given, std::less<>>;

[[noreturn]] void fail(const std::string& place, std::string_view key, const std::string& what) {
  throw Error(ErrorKind::bad_config, place + ": key " + std::string(key) + ": " + what);
}

bool is_section(const std::string& path) {
  return std::ranges::any_of(mission_keys(),
                             [&](const Key& key) { return key.path.starts_with(path + "."); });
}

/// Files the values of a map, and of the maps in it, under their keys.
void collect(const YamlNode& map, const std::string& prefix, const std::string& name,
             GivenValues& values) {
  for (const YamlEntry& entry : map.entries) {
    const std::string path = prefix + entry.key;
    const std::string place = name + ":" + std::to_string(entry.line);
    if (find_key(path)) {
      values[path] = {place, entry.value};
    } else if (!is_section(path)) {
      fail(place, path, unknown_key_message(path));
    } else if (entry.value.kind == YamlNode::Kind::map) {
      collect(entry.value, path + ".", name, values);
    } else {
      fail(place, path, "is a section; put its keys below it, indented");
    }
  }
}

template <class Number>
std::optional<Number> parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string described(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      return "has no value";
    case YamlNode::Kind::list:
      return "is a list";
    case YamlNode::Kind::map:
      return "is a map";
    case YamlNode::Kind::scalar:
      break;
  }
  const std::string text = node.text.size() <= 60 ? node.text : node.text.substr(0, 60) + "...";
  return node.is_quoted ? "is the text '" + text + "'" : "is " + text;
}

bool contains(const KeyRange& range, double value) {
  return value <= range.most && (range.excludes_least ? value > range.least : value >= range.least);
}

/// The node's number if it is one, finite, and in range.
std::optional<double> number_in(const YamlNode& node, const KeyRange& range) {
  if (node.kind != YamlNode::Kind::scalar || node.is_quoted) return std::nullopt;
  const auto number = parsed<double>(node.text);
  if (!number || !std::isfinite(*number) || !contains(range, *number)) return std::nullopt;
  return number;
}

std::optional<Eigen::Vector3d> vector_in(const YamlNode& node, const KeyRange& range) {
  if (node.items.size() != 3) return std::nullopt;
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) {
    const auto number = number_in(node.items[axis], range);
    if (!number) return std::nullopt;
    vector[axis] = *number;
  }
  return vector;
}

std::optional<std::vector<Eigen::Vector2d>> polygon_in(const YamlNode& node) {
  std::vector<Eigen::Vector2d> polygon;
  for (const YamlNode& corner : node.items) {
    if (corner.items.size() != 2) return std::nullopt;
    const auto x = number_in(corner.items[0], {}), y = number_in(corner.items[1], {});
    if (!x || !y) return std::nullopt;
    polygon.push_back({*x, *y});
  }
  return polygon.size() >= 3 ? std::optional(polygon) : std::nullopt;
}

std::optional<geometry::Prism> volume_in(const YamlNode& node) {
  const auto entry = [&](std::string_view name) {
    const auto found = std::ranges::find(node.entries, name, &YamlEntry::key);
    return found == node.entries.end() ? YamlNode{} : found->value;
  };
  const auto corners = polygon_in(entry("corners"));
  const auto bottom = number_in(entry("bottom"), {}), top = number_in(entry("top"), {});
  if (node.entries.size() != 3 || !corners || !bottom || !top || *bottom >= *top) {
    return std::nullopt;
  }
  return geometry::Prism{.name = "", .footprint = *corners, .floor = *bottom, .ceiling = *top};
}

template <typename Item, typename ReadItem>
std::optional<KeyValue> list_in(const YamlNode& node, const ReadItem& read_item) {
  if (node.kind != YamlNode::Kind::list) return std::nullopt;
  std::vector<Item> list;
  for (const YamlNode& item : node.items) {
    std::optional<Item> value = read_item(item);
    if (!value) return std::nullopt;
    list.push_back(std::move(*value));
  }
  return list;
}

bool is_control_character(unsigned char c) { return c < 0x20 || c == 0x7f; }

/// The node's value as `key` takes it; nothing if it does not.
std::optional<KeyValue> value_for(const Key& key, const YamlNode& node) {
  if (key.type == KeyType::vector) return vector_in(node, key.range);
  if (key.type == KeyType::polygon) return polygon_in(node);
  if (key.type == KeyType::volumes) return list_in<geometry::Prism>(node, volume_in);
  const auto vector = [&](const YamlNode& item) { return vector_in(item, key.range); };
  if (key.type == KeyType::vectors) return list_in<Eigen::Vector3d>(node, vector);
  if (key.type == KeyType::number) return number_in(node, key.range);
  if (node.kind != YamlNode::Kind::scalar) return std::nullopt;
  switch (key.type) {
    case KeyType::integer: {
      const auto number = parsed<std::int64_t>(node.text);
      if (!number || node.is_quoted || !contains(key.range, static_cast<double>(*number))) break;
      return *number;
    }
    case KeyType::boolean:
      if (node.is_quoted || (node.text != "true" && node.text != "false")) break;
      return node.text == "true";
    case KeyType::choice:
      if (std::ranges::find(key.choices, node.text) == key.choices.end()) break;
      return node.text;
    default:
      if (node.text.empty() || std::ranges::any_of(node.text, is_control_character)) break;
      return node.text;
  }
  return std::nullopt;
}

void apply(const Given& given, const Key& key, Mission& mission) {
  const auto value = value_for(key, given.node);
  if (!value) fail(given.place, key.path, described(given.node) + "; give " + expected_value(key));
  key.set(mission, *value);
}

/// Sets up what the named presets stand for, before the other keys override it.
void apply_presets(Mission& mission) {
  if (mission.sensor.preset == SensorPreset::high_resolution) {
    mission.sensor.camera = sim::high_resolution();
  }
  survey::see::SeeConfig& see = mission.planner.see;
  if (mission.planner.name == PlannerName::see) {
    see.optimise_views = false;
    see.visibility_graph = false;
  }
  if (mission.planner.preset == PlannerPreset::building) {
    see.visibility_update_limit = 1000;
    see.max_attempts = 2;
  }
}

/// Reads the scanner that takes the camera's place.
void apply_lidar(const GivenValues& given, const std::string& name, Mission& mission) {
  for (const auto& [path, value] : given) {
    if (path.starts_with("sensor.") && path != "sensor.lidar") {
      fail(value.place, path, "does not go with sensor.lidar; leave one of the two out");
    }
  }
  const std::string& place = given.at("sensor.lidar").place;
  if (mission.flight.is_flown()) {
    fail(place, "sensor.lidar",
         "does not go with flight.vehicle: free space to fly in is proven by depth images; give "
         "flight.vehicle: none, or a depth camera");
  }
  try {
    derived::use_lidar(mission.sensor, std::filesystem::path(name).parent_path());
  } catch (const Error& error) {
    fail(place, "sensor.lidar", error.what());
  }
}

/// The building preset's lengths, which follow from other values, where no key says otherwise.
///
/// At building scale the published psi looks at a small part of the sight line only, and targets
/// hidden by the building itself are taken for visible; it is therefore the whole line. One view
/// proposal within a twentieth of d keeps the number of proposals below tau.
void derive_building_preset(const GivenValues& given, Mission& mission) {
  survey::see::SeeConfig& see = mission.planner.see;
  const double distance =
      see.view_distance
          ? *see.view_distance
          : geometry::view_distance(geometry::Camera(mission.sensor.camera.camera), see.density);
  const auto is_given = [&](const char* key) { return given.contains(key); };
  if (!is_given("planner.occlusion_search_distance")) see.occlusion_search_distance = distance;
  if (!is_given("planner.frontier_spacing")) see.frontier_spacing = 0.05 * distance;
  if (!is_given("planner.occluder_spacing")) see.occluder_spacing = 2.0 * see.resolution_radius;
}

/// Throws if keys that are fine alone contradict each other.
void check_together(const GivenValues& given, const std::string& name, const Mission& mission) {
  const auto place = [&](const char* key) {
    const auto found = given.find(key);
    return found == given.end() ? name + ":1" : found->second.place;
  };
  if (mission.name.find('/') != std::string::npos || mission.name.starts_with('.')) {
    fail(place("name"), "name",
         "is " + mission.name + "; it names a folder, give it without '/' and leading '.'");
  }
  const SceneConfig& scene = mission.scene;
  if (given.contains("scene.detail") && !scene.model.starts_with("builtin:")) {
    fail(place("scene.detail"), "scene.detail",
         "needs a builtin model; " + scene.model + " is as detailed as its file");
  }
  if (scene.longest_side && scene.scale) {
    fail(place("scene.scale"), "scene.scale", "excludes scene.longest_side; keep one of the two");
  }
  if (scene.ground && !mission.planner.see.scene_box) {
    fail(place("scene.ground"), "scene.ground",
         "needs planner.scene_box, or the plan would cover the ground too; give the box's min "
         "and max");
  }
  if (const auto& box = mission.planner.see.scene_box;
      box && !(box->min().array() < box->max().array()).all()) {
    fail(place("planner.scene_box.max"), "planner.scene_box.max",
         "is not above planner.scene_box.min on every axis; swap or widen the corners");
  }
  const StartConfig& start = mission.start;
  if (!start.position && (start.look_at || start.direction)) {
    const char* key = start.look_at ? "start.look_at" : "start.direction";
    fail(place(key), key, "needs start.position; give it, or leave both out for a random start");
  }
  if (start.position && start.look_at.has_value() == start.direction.has_value()) {
    fail(place("start.position"), "start.position",
         "needs either start.look_at or start.direction");
  }
  if (start.direction && start.direction->norm() < 1e-6) {
    fail(place("start.direction"), "start.direction", "has no length; give a vector that has");
  }
  if (start.look_at && (*start.look_at - *start.position).norm() < 1e-6) {
    fail(place("start.look_at"), "start.look_at", "is the start's position; give another point");
  }
  const geometry::CameraConfig& camera = mission.sensor.camera.camera;
  if (camera.max_range <= camera.min_range) {
    fail(place("sensor.max_range"), "sensor.max_range",
         "is not above sensor.min_range; make it larger");
  }
  if (static_cast<double>(camera.width) * camera.height > 1e8) {
    fail(place("sensor.width"), "sensor.width",
         "times sensor.height is more than 1e8 pixels; make the image smaller");
  }
}

/// The same for where the sensor may be.
void check_site(const GivenValues& given, const std::string& name, const Mission& mission) {
  const auto complain = [&](const char* key, const std::string& what) {
    const auto found = given.find(key);
    fail(found == given.end() ? name + ":1" : found->second.place, key, what);
  };
  const survey::ViewLimits limits = derived::view_limits(mission);
  if (limits.least_height && limits.most_height && *limits.least_height >= *limits.most_height) {
    complain("site.highest_height",
             "is not above site.lowest_height and limits.ground_clearance; nothing is left to fly "
             "in");
  }
  if (limits.least_pitch >= limits.most_pitch) {
    complain("limits.highest_pitch_deg", "is not above limits.lowest_pitch_deg; raise it");
  }
}

/// The same for what makes a flight.
void check_flight(const GivenValues& given, const std::string& name, const Mission& mission) {
  const auto complain = [&](const char* key, const std::string& what) {
    const auto found = given.find(key);
    fail(found == given.end() ? name + ":1" : found->second.place, key, what);
  };
  const Georeference& place = mission.georeference;
  if (place.latitude.has_value() != place.longitude.has_value()) {
    complain(place.latitude ? "site.latitude_deg" : "site.longitude_deg",
             "is half a place; give site.latitude_deg and site.longitude_deg");
  }
  const FlightConfig& flight = mission.flight;
  if (!flight.is_flown()) return;
  if (const auto& box = flight.unknown_box;
      box && !(box->min().array() < box->max().array()).all()) {
    complain("flight.unknown_box.max",
             "is not above flight.unknown_box.min on every axis; swap or widen the corners");
  }
  if (derived::unknown_box_of(mission).isEmpty()) {
    complain("flight.vehicle",
             "needs flight.unknown_box, around the building: in it nothing is free until measured; "
             "give the box's min and max");
  }
  const flight::ClearanceBudget budget = derived::clearance_of(mission);
  if (budget.margin < 0.0) {
    complain("flight.clearance",
             "is less than the vehicle's radius of " + short_text(budget.vehicle_radius) +
                 " m and the position, tracking and map errors make together, " +
                 short_text(budget.total() - budget.margin) +
                 " m; make it larger or the errors smaller");
  }
  if (derived::takeoff_climb_of(mission) <= flight.clearance) {
    complain("flight.takeoff_climb", "of " + short_text(derived::takeoff_climb_of(mission)) +
                                         " m ends within the clearance of the ground; make it more "
                                         "than flight.clearance");
  }
  const double sigma = mission.sensor.camera.noise.sigma;
  if (flight.map_error < 3.0 * sigma) {
    complain("flight.map_error",
             "is below three standard deviations of the sensor's noise; make "
             "it at least " +
                 short_text(3.0 * sigma) + " m");
  }
  if (flight.wind_speed >= derived::vehicle_of(mission).max_wind) {
    complain("flight.wind_speed", "is not below the " +
                                      short_text(derived::vehicle_of(mission).max_wind) +
                                      " m/s that " + flight.vehicle + " is made for");
  }
}

/// Lets the planner check its parameters, and finds the place of the key that it complains of.
void check_planner(const GivenValues& given, const std::string& name, const Mission& mission) {
  try {
    mission.planner.see.validate();
  } catch (const Error& error) {
    const std::string_view message = error.what();
    std::string field(message.substr(0, message.find(' ')));
    std::string_view what = message.substr(std::min(field.size() + 1, message.size()));
    if (!field.starts_with("planner.")) field = "planner." + field;
    if (!find_key(field)) fail(name + ":1", "planner", std::string(message));
    const auto found = given.find(field);
    fail(found == given.end() ? name + ":1" : found->second.place, field, std::string(what));
  }
}

void check_required(const GivenValues& given, const std::string& name) {
  for (const Key& key : mission_keys()) {
    if (!key.is_required || given.contains(key.path)) continue;
    fail(name + ":1", key.path, "is missing; give " + expected_value(key));
  }
}

GivenValues collected(const std::string& text, const std::string& name,
                      const std::vector<KeyOverride>& overrides) {
  const YamlNode root = parse_yaml(text, name);
  if (root.kind == YamlNode::Kind::null) {
    throw Error(ErrorKind::bad_config, name +
                                           ":1: is empty; a mission needs at least scene.model and "
                                           "evaluation.registration_distance");
  }
  if (root.kind != YamlNode::Kind::map) {
    throw Error(ErrorKind::bad_config, name + ":" + std::to_string(root.line) +
                                           ": is not a map; a mission is a list of 'key: value'");
  }
  GivenValues values;
  collect(root, "", name, values);
  for (const auto& [origin, path, value] : overrides) {
    if (!find_key(path)) fail(origin, path, unknown_key_message(path));
    // What a publication reports is for the planner that the file names.
    if (path == "planner.name") {
      std::erase_if(values, [](const auto& entry) { return entry.first.starts_with("paper."); });
    }
    values[path] = {origin, parse_yaml(value, origin)};
  }
  return values;
}

Mission mission_from(const std::string& text, const std::string& name,
                     const std::vector<KeyOverride>& overrides) {
  const GivenValues given = collected(text, name, overrides);
  Mission mission;
  mission.name = std::filesystem::path(name).stem().string();

  constexpr std::array presets{"sensor.preset", "sensor.lidar", "planner.preset", "planner.name",
                               "flight.vehicle"};
  for (const char* path : presets) {
    const auto preset = given.find(path);
    if (preset != given.end()) apply(preset->second, *find_key(path), mission);
  }
  // What flies is there to be done soon: the paper's planners are for comparison.
  if (mission.flight.is_flown() && !given.contains("planner.name")) {
    mission.planner.name = PlannerName::skycap;
  }
  apply_presets(mission);
  if (mission.sensor.lidar) apply_lidar(given, name, mission);
  for (const auto& [path, value] : given) apply(value, *find_key(path), mission);
  check_required(given, name);
  check_together(given, name, mission);
  check_flight(given, name, mission);

  if (mission.planner.preset == PlannerPreset::building) derive_building_preset(given, mission);
  if (mission.flight.is_flown() && !mission.limits.ground_clearance) {
    // A little more, so that a view at the limit can be proven.
    mission.limits.ground_clearance = mission.flight.clearance + 0.01;
  }
  if (mission.scene.ground && !mission.limits.ground_clearance) mission.limits.ground_clearance = 0;
  if (mission.limits.ground_clearance) {
    mission.planner.see.least_height =
        mission.scene.position.z() + *mission.limits.ground_clearance;
  }
  check_site(given, name, mission);
  check_planner(given, name, mission);
  return mission;
}

/// Keys and texts are shown as they were written; what would break the line becomes a space.
std::string one_line(std::string message) {
  std::ranges::replace_if(message, is_control_character, ' ');
  return message;
}

}  // namespace

Mission parse_mission(const std::string& text, const std::string& name,
                      const std::vector<KeyOverride>& overrides) {
  try {
    return mission_from(text, name, overrides);
  } catch (const Error& error) {
    throw Error(error.kind(), one_line(error.what()));
  }
}

Mission read_mission(const std::filesystem::path& file, const std::vector<KeyOverride>& overrides) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::bad_file, file.string() + ": " + what);
  };
  std::error_code failure;
  if (std::filesystem::is_directory(file, failure)) refuse("is a folder; name a mission file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    refuse(std::string("cannot be read (") + std::generic_category().message(errno) +
           "); check its name");
  std::string text(largest_file + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > largest_file) refuse("is larger than 1 MiB; that is not a mission file");
  if (text.find('\0') != std::string::npos) refuse("is not text; name a mission file");
  return parse_mission(text, file.string(), overrides);
}

}  // namespace skycap::missions::file
