// Descriptions of the key table for error messages, editors and the manual.
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "missions/config/mission_keys.h"
#include "missions/config/setting_json.h"

namespace skycap::missions::config {
namespace {

using Json = nlohmann::ordered_json;

constexpr double unlimited = std::numeric_limits<double>::max();

/// Formats with twelve digits, which hides rounding errors of angles stored in radians.
std::string number_text(double value) { return fmt::format("{:.12g}", value); }

std::string range_text(const KeyRange& range) {
  const bool has_min = range.min > -unlimited;
  const bool has_max = range.max < unlimited;
  std::string text;
  if (has_min && range.excludes_min) {
    text = " above " + number_text(range.min);
    if (has_max) text += " and at most " + number_text(range.max);
  } else if (has_min && has_max) {
    text = " from " + number_text(range.min) + " to " + number_text(range.max);
  }
  return text;
}

std::string listed(const std::vector<std::string>& choices) {
  std::string text;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (i > 0) text += i + 1 < choices.size() ? ", " : " or ";
    text += choices[i];
  }
  return text;
}

/// Returns the default of a key: a value or a description.
std::string default_text(const Key& key) {
  if (key.is_required) return "required";
  if (!key.fallback.empty()) return key.fallback;
  MissionDocument blank;
  blank.prior.emplace_back();  // for keys of maps in a list
  return to_text(*key.get(blank));
}

Json number_schema(const Key& key, const char* type) {
  Json schema{{"type", type}};
  if (key.range.min > -unlimited) {
    schema[key.range.excludes_min ? "exclusiveMinimum" : "minimum"] = key.range.min;
  }
  if (key.range.max < unlimited) schema["maximum"] = key.range.max;
  return schema;
}

Json vector_schema(const Key& key) {
  return {
      {"type", "array"}, {"items", number_schema(key, "number")}, {"minItems", 3}, {"maxItems", 3}};
}

Json polygon_schema(int min_corners = 3) {
  const Json corner{
      {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 2}, {"maxItems", 2}};
  return {{"type", "array"}, {"items", corner}, {"minItems", min_corners}};
}

Json volumes_schema() {
  const Json volume{{"type", "object"},
                    {"additionalProperties", false},
                    {"required", {"corners", "floor", "ceiling"}},
                    {"properties",
                     {{"corners", polygon_schema()},
                      {"floor", {{"type", "number"}}},
                      {"ceiling", {{"type", "number"}}}}}};
  return {{"type", "array"}, {"items", volume}};
}

std::string vector_text(const Eigen::Vector3d& vector) {
  return "[" + number_text(vector.x()) + ", " + number_text(vector.y()) + ", " +
         number_text(vector.z()) + "]";
}

std::string polygon_text(const std::vector<Eigen::Vector2d>& polygon) {
  std::string text;
  for (const Eigen::Vector2d& corner : polygon) {
    text += (text.empty() ? "[" : ", [") + number_text(corner.x()) + ", " +
            number_text(corner.y()) + "]";
  }
  return "[" + text + "]";
}

std::string volumes_text(const std::vector<geometry::Prism>& volumes) {
  std::string text;
  for (const geometry::Prism& volume : volumes) {
    text += (text.empty() ? "" : ", ") + std::string("{corners: ") +
            polygon_text(volume.footprint) + ", floor: " + number_text(volume.floor) +
            ", ceiling: " + number_text(volume.ceiling) + "}";
  }
  return "[" + text + "]";
}

Json sources_schema(const Key& key);

Json value_schema(const Key& key) {
  switch (key.type) {
    case KeyType::text:
      return {{"type", "string"}, {"minLength", 1}};
    case KeyType::number:
      if (key.choices.empty()) return number_schema(key, "number");
      return {{"anyOf", {number_schema(key, "number"), {{"enum", key.choices}}}}};
    case KeyType::integer:
      return number_schema(key, "integer");
    case KeyType::boolean:
      return {{"type", "boolean"}};
    case KeyType::choice:
      return {{"enum", key.choices}};
    case KeyType::polygon:
      return polygon_schema();
    case KeyType::line:
      return polygon_schema(2);
    case KeyType::volumes:
      return volumes_schema();
    case KeyType::vectors:
      return {{"type", "array"}, {"items", vector_schema(key)}};
    case KeyType::texts:
      return {{"type", "array"}, {"items", {{"type", "string"}, {"minLength", 1}}}};
    case KeyType::integers:
      return {{"type", "array"}, {"items", number_schema(key, "integer")}};
    case KeyType::pairs:
      return {{"type", "object"}, {"additionalProperties", {{"type", "string"}}}};
    case KeyType::sources:
      return sources_schema(key);
    case KeyType::vector:
      break;
  }
  return vector_schema(key);
}

Json section_schema() {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
}

/// Adds `key` to the schema of its section; missing parent sections are created.
void add_to_schema(const Key& key, Json& root) {
  Json* section = &root;
  std::string_view rest = key.path;
  for (auto dot = rest.find('.');; dot = rest.find('.')) {
    const std::string part(rest.substr(0, dot));
    if (key.is_required) {
      Json& names = (*section)["required"];
      if (std::find(names.begin(), names.end(), part) == names.end()) names.push_back(part);
    }
    Json& properties = (*section)["properties"];
    if (dot == std::string_view::npos) {
      properties[part] = value_schema(key);
      properties[part]["description"] =
          key.meaning + (key.unit.empty() ? "" : " [" + key.unit + "]") +
          (key.is_required ? "" : " Default: " + default_text(key) + ".");
      return;
    }
    if (!properties.contains(part)) properties[part] = section_schema();
    section = &properties[part];
    rest.remove_prefix(dot + 1);
  }
}

Json sources_schema(const Key& key) {
  Json map = section_schema();
  for (const Key& item : key.items) add_to_schema(item, map);
  return {{"type", "array"}, {"items", map}};
}

void add_to_table(const Key& key, const std::string& prefix, std::ostream& table) {
  const std::string path = prefix + key.path;
  table << "| `" << path << "` | " << expected_value(key) << " | " << default_text(key) << " | "
        << key.meaning << " |\n";
  for (const Key& item : key.items) add_to_table(item, path + "[].", table);
}

}  // namespace

std::string expected_value(const Key& key) {
  const std::string unit = key.unit.empty() ? "" : " [" + key.unit + "]";
  switch (key.type) {
    case KeyType::text:
      return "a string";
    case KeyType::number:
      return (key.choices.empty() ? "" : listed(key.choices) + " or ") + "a number" +
             range_text(key.range) + unit;
    case KeyType::integer:
      return "an integer" + range_text(key.range) + unit;
    case KeyType::boolean:
      return "true or false";
    case KeyType::choice:
      return listed(key.choices);
    case KeyType::polygon:
      return "three or more corners [x, y]" + unit;
    case KeyType::line:
      return "two or more points [x, y]" + unit;
    case KeyType::volumes:
      return "a list of {corners, floor, ceiling}" + unit;
    case KeyType::vectors:
      return "a list of lists of three numbers" + range_text(key.range) + unit;
    case KeyType::texts:
      return "a list of strings";
    case KeyType::integers:
      return "a list of integers" + range_text(key.range);
    case KeyType::pairs:
      return "a map of strings";
    case KeyType::sources:
      return "a list of YAML mappings, each with file, role and further keys";
    case KeyType::vector:
      break;
  }
  return "a list of three numbers" + range_text(key.range) + unit;
}

std::string to_text(const KeyValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* number = std::get_if<double>(&value)) return number_text(*number);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* volumes = std::get_if<std::vector<geometry::Prism>>(&value)) {
    return volumes_text(*volumes);
  }
  if (const auto* polygon = std::get_if<std::vector<Eigen::Vector2d>>(&value)) {
    return polygon_text(*polygon);
  }
  if (const auto* vectors = std::get_if<std::vector<Eigen::Vector3d>>(&value)) {
    std::string text;
    for (const Eigen::Vector3d& vector : *vectors) {
      text += (text.empty() ? "" : ", ") + vector_text(vector);
    }
    return "[" + text + "]";
  }
  if (const auto* vector = std::get_if<Eigen::Vector3d>(&value)) return vector_text(*vector);
  return setting_json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string mission_json_schema() {
  Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
              {"title", "Skycap mission"},
              {"description", "A survey to be planned and simulated with `skycap plan`."}};
  schema.update(section_schema());
  for (const Key& key : mission_keys()) add_to_schema(key, schema);
  // Mutually exclusive and dependent keys.
  schema["properties"]["scene"]["not"] = {{"required", {"longest_side", "scale"}}};
  schema["properties"]["start"]["dependencies"] = {
      {"position", {{"oneOf", {{{"required", {"look_at"}}}, {{"required", {"direction"}}}}}}},
      {"look_at", {"position"}},
      {"direction", {"position"}}};
  return schema.dump(2) + "\n";
}

std::string mission_key_table() {
  std::ostringstream table;
  table << "| key | value | default | meaning |\n| --- | --- | --- | --- |\n";
  for (const Key& key : mission_keys()) {
    add_to_table(key, "", table);
  }
  return table.str();
}

}  // namespace skycap::missions::config
