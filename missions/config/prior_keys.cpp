// Key `prior` and the keys of the maps in its list.
#include <algorithm>

#include "geometry/angle.h"
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"
#include "missions/site_data/prior_text.h"

namespace skycap::missions::config {
namespace {

using site_data::HeightDatum;
using site_data::Role;
using site_data::Source;

/// Returns the names of all values of an enumeration, in order.
template <typename Word>
std::vector<std::string> to_strings(std::initializer_list<Word> all) {
  std::vector<std::string> names;
  for (const Word each : all) names.emplace_back(to_string(each));
  return names;
}

/// Return accessors of a member of the list's last source.
auto source(auto member) {
  return [member](auto& m) -> auto& { return m.prior.back().*member; };
}
auto selection(auto member) {
  return [member](auto& m) -> auto& { return m.prior.back().select.*member; };
}

/// Creates an optional string key.
template <class Field>
Key optional_text_key(std::string path, std::string fallback, Field field, std::string meaning) {
  Key key = list_key(std::move(path), KeyType::text, field, std::move(meaning));
  return otherwise(std::move(fallback), std::move(key));
}

/// Creates a key with a path.
template <class Field>
Key path_key(std::string path, Field field, std::string meaning) {
  Key key;
  key.path = std::move(path);
  key.meaning = std::move(meaning);
  key.set = [field](MissionDocument& mission, const KeyValue& value) {
    field(mission) = std::get<std::string>(value);
  };
  key.get = [field](const MissionDocument& mission) -> std::optional<KeyValue> {
    const std::string text = field(mission).string();
    return text.empty() ? std::nullopt : std::optional<KeyValue>(text);
  };
  return key;
}

Key vertical_key() {
  Key key;
  key.path = "vertical";
  key.type = KeyType::choice;
  key.choices = to_strings({HeightDatum::ellipsoid, HeightDatum::geoid, HeightDatum::takeoff});
  key.meaning =
      "Vertical datum of the file's heights: the WGS84 ellipsoid, the geoid (the file's own, "
      "otherwise EGM96), or the take-off point.";
  key.set = [names = key.choices](MissionDocument& mission, const KeyValue& value) {
    const auto name = std::ranges::find(names, std::get<std::string>(value));
    mission.prior.back().vertical = static_cast<HeightDatum>(name - names.begin());
  };
  key.get = [names = key.choices](const MissionDocument& mission) -> std::optional<KeyValue> {
    const auto& stored = mission.prior.back().vertical;
    if (!stored) return std::nullopt;
    return names[static_cast<std::size_t>(*stored)];
  };
  return otherwise("that of the coordinate reference system, if any; otherwise the mission frame",
                   key);
}

Key up_axis_key() {
  Key key;
  key.path = "up_axis";
  key.type = KeyType::choice;
  key.choices = {"z", "y"};
  key.meaning = "Axis of scene models that points up; overrides the file.";
  key.set = [](MissionDocument& mission, const KeyValue& value) {
    mission.prior.back().is_y_up = std::get<std::string>(value) == "y";
  };
  key.get = [](const MissionDocument& mission) -> std::optional<KeyValue> {
    const std::optional<bool>& stored = mission.prior.back().is_y_up;
    return stored ? std::optional<KeyValue>(*stored ? "y" : "z") : std::nullopt;
  };
  return otherwise("from the file, otherwise z", key);
}

Key base_key() {
  Key key;
  key.path = "base";
  key.type = KeyType::number;
  key.unit = std::string(1, 'm');  // avoids a false warning of GCC 12 for string literals
  key.range = between(-1e4, 1e4);
  key.choices = {"terrain"};
  key.meaning = "Base height of extruded polygons.";
  key.set = [](MissionDocument& mission, const KeyValue& value) {
    Source& source = mission.prior.back();
    source.base_on_terrain = std::holds_alternative<std::string>(value);
    if (!source.base_on_terrain) source.base = std::get<double>(value);
  };
  key.get = [](const MissionDocument& mission) -> std::optional<KeyValue> {
    const Source& source = mission.prior.back();
    if (source.base_on_terrain) return std::string("terrain");
    return source.base ? std::optional<KeyValue>(*source.base) : std::nullopt;
  };
  return otherwise("from the file", key);
}

/// Creates a key of the optional georeference, which is created when the first of its keys is set.
template <class Value>
Key source_pose_key(std::string path, KeyType type, std::string unit, KeyRange range, double factor,
                    Value site_data::SourcePose::*member, std::string meaning) {
  Key key;
  key.path = std::move(path);
  key.type = type;
  key.unit = std::move(unit);
  key.range = range;
  key.meaning = std::move(meaning);
  key.set = [=](MissionDocument& mission, const KeyValue& value) {
    std::optional<site_data::SourcePose>& pose = mission.prior.back().pose;
    if (!pose) pose.emplace();
    (*pose).*member = factor * std::get<Value>(value);
  };
  key.get = [=](const MissionDocument& mission) -> std::optional<KeyValue> {
    const std::optional<site_data::SourcePose>& pose = mission.prior.back().pose;
    if (!pose) return std::nullopt;
    return KeyValue(Value((*pose).*member / factor));
  };
  return key;
}

/// Returns the keys of file, role and georeference.
std::vector<Key> source_pose_keys() {
  return {
      required(path_key("file", source(&Source::file),
                        "Map, model, terrain or scan, relative to the mission file. The format is "
                        "detected by content (docs/reference/prior-formats.md).")),
      required(choice_key(
          "role", to_strings({Role::target, Role::obstacle, Role::terrain, Role::truth}),
          source(&Source::role),
          "Role in the survey. target: the object to survey; serves as predicted surface until it "
          "is measured. obstacle: every leg avoids it. terrain: the ground. truth: ground truth "
          "for the simulated sensor, instead of scene.model. No role marks space as free.")),
      optional_text_key("crs", "that of the file, if any; otherwise the mission frame",
                        source(&Source::crs),
                        "Coordinate reference system, horizontal or compound, for example "
                        "EPSG:25832+7837; all systems that PROJ supports."),
      vertical_key(),
      otherwise("-",
                source_pose_key("place.position", KeyType::vector, "m", between(-1e6, 1e6), 1.0,
                                &site_data::SourcePose::position,
                                "Position of the origin of a file without a coordinate reference "
                                "system, in the mission frame; conflicts with crs.")),
      otherwise("0",
                source_pose_key("place.heading_deg", KeyType::number, "degrees", between(-360, 360),
                                geometry::radians_per_degree, &site_data::SourcePose::heading,
                                "Direction of the file's y axis, clockwise from north.")),
      vector_key(
          "offset", "m", between(-1e8, 1e8), source(&Source::offset),
          "Coordinate offset (global shift) added to all coordinates, in the file's system."),
      otherwise("from the file, otherwise 1",
                number_key("unit", "m", above(0, 1e6), source(&Source::unit),
                           "Linear unit: length of one unit of the file's coordinates.")),
      up_axis_key(),
  };
}

/// Returns the keys that select a part of a file.
std::vector<Key> selection_keys() {
  using site_data::Selection;
  const auto all = [](Key key) { return otherwise("all", std::move(key)); };
  Key classes = all(list_key("select.classes", KeyType::integers, selection(&Selection::classes),
                             "Point clouds: only points of these ASPRS classes."));
  classes.range = between(0, 255);
  return {
      all(list_key("select.id", KeyType::texts, selection(&Selection::ids),
                   "Only objects with these names, and their parts.")),
      all(list_key("select.attribute", KeyType::pairs, selection(&Selection::attributes),
                   "Only objects with these attributes.")),
      all(path_key("select.within", selection(&Selection::within),
                   "Only data inside the polygons of this file.")),
      classes,
      optional_text_key("select.layer", "all", selection(&Selection::layer),
                        "Only this layer of the file."),
      otherwise("the highest level of each object",
                number_key("select.lod", "", between(0, 4), selection(&Selection::lod),
                           "Only this level of detail.")),
  };
}

/// Returns the keys that specify the interpretation of a file.
std::vector<Key> meaning_keys() {
  return {
      base_key(),
      otherwise("from the file", number_key("height", "m", above(0, 1e4), source(&Source::height),
                                            "Height of polygons above their base.")),
      optional_text_key("height_attribute",
                        "height and its variants, otherwise the number of storeys",
                        source(&Source::height_attribute),
                        "Map attribute that contains the height of a polygon above its base."),
      number_key("min_height", "m", between(0, 1e4), source(&Source::min_height),
                 "Height of the lower edge of polygons above their base."),
      otherwise("0.3; 1 for extruded polygons",
                number_key(
                    "uncertainty", "m", between(0, 1000), source(&Source::uncertainty),
                    "Uncertainty of the data. Obstacles are enlarged by this distance, in addition "
                    "to flight.map_error. The error of a substitute geoid or datum is added.")),
      otherwise("0.25", number_key("spacing", "m", above(0, 100), source(&Source::spacing),
                                   "Voxel-grid downsampling of point clouds: one point per cube of "
                                   "this side, which should be at least the point spacing.")),
  };
}

}  // namespace

std::vector<Key> prior_keys() {
  Key key = key_for(
      "prior", KeyType::sources, [](auto& m) -> auto& { return m.prior; },
      "Prior data: information about the site that is known before the survey "
      "(docs/howto/use-prior-data.md).");
  key.get = [](const MissionDocument& mission) -> std::optional<KeyValue> {
    return mission.prior.empty() ? std::nullopt : std::optional<KeyValue>(mission.prior);
  };
  key.items = joined({source_pose_keys(), selection_keys(), meaning_keys()});
  return {otherwise("none", key)};
}

}  // namespace skycap::missions::config
