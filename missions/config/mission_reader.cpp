#include "missions/config/mission_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/config/former_names.h"
#include "missions/config/mission_keys.h"
#include "missions/config/unknown_key.h"
#include "missions/support/key_text.h"
#include "missions/support/yaml_tree.h"

namespace skycap::missions::config {
namespace {

constexpr std::size_t largest_file = 1 << 20;  // [byte]; missions typically have a few thousand

/// YAML value with its location.
struct ParsedValue {
  std::string file;      ///< file name or option name
  std::string location;  ///< "FILE:LINE" or option name
  support::YamlNode node;
};

/// Values by key path. The keys are known; the values are not yet parsed.
using ParsedValues = std::map<std::string, ParsedValue, std::less<>>;

/// Keys permitted in a map, and their prefix in messages.
struct KnownKeys {
  std::span<const Key> keys;
  std::string of;  ///< prefix of keys in messages, such as "prior[0]."
  std::string file;

  const Key* find(std::string_view path) const {
    const auto key = std::ranges::find(keys, path, &Key::path);
    return key == keys.end() ? nullptr : &*key;
  }
  bool has_section(const std::string& path) const {
    return std::ranges::any_of(keys,
                               [&](const Key& key) { return key.path.starts_with(path + "."); });
  }
};

[[noreturn]] void fail(const std::string& location, std::string_view key, const std::string& what) {
  throw Error(ErrorKind::bad_config, location + ": key " + support::about_key(key, what));
}

/// Returns the current key path of an override, and its value with current names.
std::pair<std::string, ParsedValue> parse_override(const KeyOverride& change) {
  std::string path = current_path(change.path);
  if (!find_key(path)) fail(change.origin, path, unknown_key_message(path, mission_keys()));
  support::YamlNode value = support::parse_yaml(change.value, change.origin);
  replace_former_names(value, path, change.origin);
  return {std::move(path), {change.origin, change.origin, std::move(value)}};
}

/// Collects the values of a map and its nested maps by key path.
void collect(const support::YamlNode& map, const std::string& prefix, const KnownKeys& known,
             ParsedValues& values) {
  for (const support::YamlEntry& entry : map.entries) {
    const std::string path = prefix + entry.key;
    const std::string location = known.file + ":" + std::to_string(entry.line);
    if (known.find(path)) {
      values[path] = {known.file, location, entry.value};
    } else if (!known.has_section(path)) {
      fail(location, known.of + path, unknown_key_message(path, known.keys));
    } else if (entry.value.kind == support::YamlNode::Kind::map) {
      collect(entry.value, path + ".", known, values);
    } else {
      fail(location, known.of + path, "is a section; indent its keys below it");
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

std::string described(const support::YamlNode& node) {
  switch (node.kind) {
    case support::YamlNode::Kind::null:
      return "has no value";
    case support::YamlNode::Kind::list:
      return "is a list";
    case support::YamlNode::Kind::map:
      return "is a map";
    case support::YamlNode::Kind::scalar:
      break;
  }
  const std::string text = node.text.size() <= 60 ? node.text : node.text.substr(0, 60) + "...";
  return node.is_quoted ? "is the string '" + text + "'" : "is " + text;
}

bool contains(const KeyRange& range, double value) {
  return value <= range.max && (range.excludes_min ? value > range.min : value >= range.min);
}

/// Returns the node's value if it is a finite number within `range`.
std::optional<double> number_in(const support::YamlNode& node, const KeyRange& range) {
  if (node.kind != support::YamlNode::Kind::scalar || node.is_quoted) return std::nullopt;
  const auto number = parsed<double>(node.text);
  if (!number || !std::isfinite(*number) || !contains(range, *number)) return std::nullopt;
  return number;
}

std::optional<Eigen::Vector3d> vector_in(const support::YamlNode& node, const KeyRange& range) {
  if (node.items.size() != 3) return std::nullopt;
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) {
    const auto number = number_in(node.items[axis], range);
    if (!number) return std::nullopt;
    vector[axis] = *number;
  }
  return vector;
}

std::optional<std::vector<Eigen::Vector2d>> polygon_in(const support::YamlNode& node,
                                                       std::size_t min_corners = 3) {
  std::vector<Eigen::Vector2d> polygon;
  for (const support::YamlNode& corner : node.items) {
    if (corner.items.size() != 2) return std::nullopt;
    const auto x = number_in(corner.items[0], {}), y = number_in(corner.items[1], {});
    if (!x || !y) return std::nullopt;
    polygon.push_back({*x, *y});
  }
  return polygon.size() >= min_corners ? std::optional(polygon) : std::nullopt;
}

std::optional<geometry::Prism> volume_in(const support::YamlNode& node) {
  const auto entry = [&](std::string_view name) {
    const auto found = std::ranges::find(node.entries, name, &support::YamlEntry::key);
    return found == node.entries.end() ? support::YamlNode{} : found->value;
  };
  const auto corners = polygon_in(entry("corners"));
  const auto floor = number_in(entry("floor"), {}), ceiling = number_in(entry("ceiling"), {});
  if (node.entries.size() != 3 || !corners || !floor || !ceiling || *floor >= *ceiling) {
    return std::nullopt;
  }
  return geometry::Prism{.name = "", .footprint = *corners, .floor = *floor, .ceiling = *ceiling};
}

template <typename Item, typename ReadItem>
std::optional<KeyValue> list_in(const support::YamlNode& node, const ReadItem& read_item) {
  if (node.kind != support::YamlNode::Kind::list) return std::nullopt;
  std::vector<Item> list;
  for (const support::YamlNode& item : node.items) {
    std::optional<Item> value = read_item(item);
    if (!value) return std::nullopt;
    list.push_back(std::move(*value));
  }
  return list;
}

bool is_control_character(unsigned char c) { return c < 0x20 || c == 0x7f; }

std::optional<std::string> text_in(const support::YamlNode& node) {
  if (node.kind != support::YamlNode::Kind::scalar || node.text.empty()) return std::nullopt;
  if (std::ranges::any_of(node.text, is_control_character)) return std::nullopt;
  return node.text;
}

std::optional<int> integer_in(const support::YamlNode& node, const KeyRange& range) {
  const auto number = number_in(node, range);
  if (!number || std::abs(*number) > 1e9 || *number != std::round(*number)) return std::nullopt;
  return static_cast<int>(*number);
}

std::optional<KeyValue> pairs_in(const support::YamlNode& node) {
  if (node.kind != support::YamlNode::Kind::map) return std::nullopt;
  std::map<std::string, std::string> pairs;
  for (const support::YamlEntry& entry : node.entries) {
    const auto text = text_in(entry.value);
    if (!text) return std::nullopt;
    pairs[entry.key] = *text;
  }
  return pairs;
}

/// Returns a number, or one of the words that the key also accepts.
std::optional<KeyValue> number_or_word(const Key& key, const support::YamlNode& node) {
  const bool is_word = node.kind == support::YamlNode::Kind::scalar &&
                       std::ranges::find(key.choices, node.text) != key.choices.end();
  if (is_word) return node.text;
  return number_in(node, key.range);
}

/// Returns the node's value in the type of `key`, or nullopt if it is invalid.
std::optional<KeyValue> value_for(const Key& key, const support::YamlNode& node) {
  if (key.type == KeyType::vector) return vector_in(node, key.range);
  if (key.type == KeyType::polygon) return polygon_in(node);
  if (key.type == KeyType::line) return polygon_in(node, 2);
  if (key.type == KeyType::volumes) return list_in<geometry::Prism>(node, volume_in);
  const auto vector = [&](const support::YamlNode& item) { return vector_in(item, key.range); };
  if (key.type == KeyType::vectors) return list_in<Eigen::Vector3d>(node, vector);
  if (key.type == KeyType::number) return number_or_word(key, node);
  if (key.type == KeyType::texts) return list_in<std::string>(node, text_in);
  const auto integer = [&](const support::YamlNode& item) { return integer_in(item, key.range); };
  if (key.type == KeyType::integers) return list_in<int>(node, integer);
  if (key.type == KeyType::pairs) return pairs_in(node);
  if (node.kind != support::YamlNode::Kind::scalar) return std::nullopt;
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
      if (const auto text = text_in(node)) return *text;
  }
  return std::nullopt;
}

[[noreturn]] void reject_value(const ParsedValue& parsed_value, const Key& key,
                               const std::string& of) {
  fail(parsed_value.location, of + key.path,
       described(parsed_value.node) + "; it must be " + expected_value(key));
}

void apply(const ParsedValue& parsed_value, const Key& key, MissionDocument& mission,
           const std::string& of = "") {
  const auto value = value_for(key, parsed_value.node);
  if (!value) reject_value(parsed_value, key, of);
  key.set(mission, *value);
}

/// Reads one map of a list. The locations of its keys are stored in `result.locations`.
site_data::Source source_in(const support::YamlNode& node, const KnownKeys& known,
                            MissionDocument& result) {
  const std::string location = known.file + ":" + std::to_string(node.line);
  const std::string name = known.of.substr(0, known.of.size() - 1);
  if (node.kind != support::YamlNode::Kind::map)
    fail(location, name, described(node) + "; it must be a map");
  ParsedValues values;
  collect(node, "", known, values);
  MissionDocument mission;
  mission.prior.emplace_back();
  result.locations[name] = location;
  for (const auto& [path, parsed_value] : values) {
    apply(parsed_value, *known.find(path), mission, known.of);
    result.locations[known.of + path] = parsed_value.location;
  }
  for (const Key& key : known.keys) {
    if (!key.is_required || values.contains(key.path)) continue;
    fail(location, known.of + key.path, "is missing; it must be " + expected_value(key));
  }
  return mission.prior.back();
}

void apply_sources(const ParsedValue& parsed_value, const Key& key, MissionDocument& result) {
  if (parsed_value.node.kind != support::YamlNode::Kind::list) reject_value(parsed_value, key, "");
  std::vector<site_data::Source> sources;
  for (const support::YamlNode& item : parsed_value.node.items) {
    const std::string of = key.path + "[" + std::to_string(sources.size()) + "].";
    sources.push_back(source_in(item, {key.items, of, parsed_value.file}, result));
  }
  key.set(result, sources);
}

/// Whether the mission describes an image of its own without naming a camera.
bool describes_camera(const MissionDocument& mission) {
  constexpr std::array image{"sensor.width", "sensor.height", "sensor.horizontal_fov_deg",
                             "sensor.vertical_fov_deg"};
  return !mission.has("sensor.preset") &&
         std::ranges::any_of(image, [&](const char* key) { return mission.has(key); });
}

/// The camera that `sensor.preset` names. The paper's two are those of the simulator to the bit.
void apply_camera(MissionDocument& mission) {
  SensorSection& sensor = mission.sensor;
  SensorDescription camera;
  try {
    camera = find_camera(sensor.preset);
  } catch (const Error& error) {
    mission.reject("sensor.preset", error.what());
  }
  if (sensor.preset == "high_resolution") {
    sensor.options.camera = sim::high_resolution();
  } else if (sensor.preset != "d435") {
    sensor.options.camera = std::get<sim::DepthCameraConfig>(camera.sensor);
  }
  if (!mission.has("sensor.max_range") && !mission.has("sensor.lidar") &&
      !describes_camera(mission)) {
    sensor.useful_range = camera.useful_range;
  }
}

/// Applies the presets, before other keys override their values.
void apply_presets(MissionDocument& mission) {
  apply_camera(mission);
  survey::see::SeeConfig& see = mission.planner.see;
  if (mission.planner.name == survey::PlannerName::see) {
    see.optimise_views = false;
    see.visibility_graph = false;
  }
  if (mission.planner.preset == PlannerPreset::building) {
    see.visibility_update_limit = 1000;
    see.max_attempts = 2;
    see.still_occluded = survey::see::StillOccluded::deferred;
  }
}

ParsedValues collected(const std::string& text, const std::string& name,
                       const std::vector<KeyOverride>& overrides) {
  support::YamlNode root = support::parse_yaml(text, name);
  if (root.kind == support::YamlNode::Kind::null) {
    throw Error(ErrorKind::bad_config, name +
                                           ":1: is empty; a mission requires at least scene.model "
                                           "and evaluation.coverage_distance");
  }
  if (root.kind != support::YamlNode::Kind::map) {
    throw Error(ErrorKind::bad_config,
                name + ":" + std::to_string(root.line) +
                    ": is not a map; a mission must consist of 'key: value' lines");
  }
  replace_former_names(root, "", name);
  ParsedValues values;
  collect(root, "", {mission_keys(), "", name}, values);
  for (const KeyOverride& change : overrides) {
    auto [path, parsed_value] = parse_override(change);
    // Published results do not apply to another planner than that in the file.
    if (path == "planner.name") {
      std::erase_if(values, [](const auto& entry) { return entry.first.starts_with("paper."); });
    }
    values[path] = std::move(parsed_value);
  }
  return values;
}

/// Records whether the user of this run states planner.file, which is executed only then.
void record_source_of_planner(const std::vector<KeyOverride>& changes, MissionDocument& document) {
  for (const KeyOverride& change : changes) {
    if (change.path == "planner.file") document.planner.is_file_by_user = change.is_by_user;
  }
}

MissionDocument mission_from(const std::string& text, const std::string& name,
                             const std::vector<KeyOverride>& overrides) {
  const ParsedValues parsed_value = collected(text, name, overrides);
  MissionDocument result{.file = name};
  for (const auto& [path, value] : parsed_value) result.locations[path] = value.location;
  result.name = std::filesystem::path(name).stem().string();

  for (const char* path : {"sensor.preset", "planner.preset", "planner.name"}) {
    const auto preset = parsed_value.find(path);
    if (preset != parsed_value.end()) apply(preset->second, *find_key(path), result);
  }
  apply_presets(result);
  for (const auto& [path, value] : parsed_value) {
    const Key& key = *find_key(path);
    key.type == KeyType::sources ? apply_sources(value, key, result) : apply(value, key, result);
  }
  record_source_of_planner(overrides, result);
  for (const Key& key : mission_keys()) {
    if (!key.is_required || parsed_value.contains(key.path)) continue;
    if (result.is_for_known_target()) continue;  // what simulated surveys of depth sensors require
    result.reject(key.path, "is missing; it must be " + expected_value(key));
  }
  return result;
}

/// Replaces control characters by spaces, so that messages with user input remain a single line.
std::string one_line(std::string message) {
  std::ranges::replace_if(message, is_control_character, ' ');
  return message;
}

}  // namespace

bool MissionDocument::has(std::string_view key) const { return locations.contains(key); }

void MissionDocument::reject(std::string_view key, const std::string& what) const {
  const auto location = locations.find(key);
  fail(one_line(location == locations.end() ? file + ":1" : location->second), key, one_line(what));
}

MissionDocument parse_mission_document(const std::string& text, const std::string& name,
                                       const std::vector<KeyOverride>& overrides) {
  try {
    return mission_from(text, name, overrides);
  } catch (const Error& error) {
    throw Error(error.kind(), one_line(error.what()));
  }
}

void override_keys(MissionDocument& document, const std::vector<KeyOverride>& changes) {
  for (const KeyOverride& change : changes) {
    const auto [path, parsed_value] = parse_override(change);
    apply(parsed_value, *find_key(path), document);
    document.locations[path] = change.origin;
  }
  record_source_of_planner(changes, document);
}

MissionDocument read_mission_document(const std::filesystem::path& file,
                                      const std::vector<KeyOverride>& overrides) {
  const auto reject = [&](const std::string& what) {
    throw Error(ErrorKind::bad_file, file.string() + ": " + what);
  };
  std::error_code failure;
  if (std::filesystem::is_directory(file, failure)) reject("is a folder; expected a mission file");
  std::ifstream stream = geometry::open_stream(file);
  if (!stream)
    reject(std::string("cannot be read (") + std::generic_category().message(errno) +
           "); check its name");
  std::string text(largest_file + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > largest_file) reject("is larger than 1 MiB; this is not a mission file");
  if (text.find('\0') != std::string::npos) reject("contains binary data; expected a mission file");
  return parse_mission_document(text, file.string(), overrides);
}

}  // namespace skycap::missions::config
