#include "missions/site_data/formats/scene_facts.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>

#include <nlohmann/json.hpp>

#include "geometry/byte_values.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/io/text/plain_text.h"
#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {
namespace {

using Json = nlohmann::json;
using std::string_view;

/// Extensions that do not affect the position of surfaces, in addition to those with the prefix
/// KHR_materials_.
constexpr std::array<string_view, 14> harmless{
    "KHR_lights_punctual",    "KHR_texture_transform",
    "KHR_texture_basisu",     "KHR_xmp",
    "KHR_xmp_json_ld",        "EXT_texture_webp",
    "EXT_texture_avif",       "MSFT_texture_dds",
    "EXT_mesh_features",      "EXT_structural_metadata",
    "EXT_feature_metadata",   "KHR_animation_pointer",
    "EXT_lights_image_based", "KHR_draco_mesh_compression"};

/// Extensions that move or hide surfaces, even if a file declares them optional.
constexpr std::array<string_view, 4> deciding{"CESIUM_RTC", "EXT_mesh_gpu_instancing",
                                              "KHR_mesh_quantization", "MSFT_lod"};

std::vector<std::string> names_in(const Json& root, const char* key) {
  std::vector<std::string> names;
  const auto list = root.find(key);
  if (list == root.end() || !list->is_array()) return names;
  for (const Json& name : *list) {
    if (name.is_string()) names.push_back(name.get<std::string>());
  }
  return names;
}

bool is_harmless(string_view name) {
  return name.starts_with("KHR_materials_") || std::ranges::find(harmless, name) != harmless.end();
}

bool is_deciding(string_view name) { return std::ranges::find(deciding, name) != deciding.end(); }

[[noreturn]] void reject_extension(const std::filesystem::path& file, const std::string& name) {
  fail_file(file, "requires the glTF extension " + one_line(name.substr(0, 60)) +
                      ", which is not supported; save the scene without it");
}

/// Access to the arguments of an IFC file's entities, which are in parentheses.
class Entities {
 public:
  explicit Entities(string_view text) : text_(text) {}

  /// Returns the arguments of the entity with a reference such as "#12". Its type must be `type`
  /// unless `type` is empty.
  std::optional<string_view> arguments(string_view reference, string_view type) const {
    std::size_t at = 0;
    while ((at = text_.find(reference, at)) != string_view::npos) {
      const std::size_t after_reference = at + reference.size();
      const std::size_t equals = text_.find_first_not_of(" \t\r\n", after_reference);
      const bool is_definition = equals != string_view::npos && text_[equals] == '=';
      at = after_reference;
      if (!is_definition) continue;
      return arguments_at(equals + 1, type);
    }
    return std::nullopt;
  }

  /// Returns the arguments of the first entity of a type.
  std::optional<string_view> first(string_view type) const {
    std::size_t at = 0;
    while ((at = upper_find(type, at)) != string_view::npos) {
      const std::size_t before = text_.find_last_not_of(" \t\r\n", at - 1);
      if (before != string_view::npos && text_[before] == '=') return arguments_at(at, type);
      at += type.size();
    }
    return std::nullopt;
  }

 private:
  /// Finds a type name in upper case, otherwise in lower case.
  std::size_t upper_find(string_view type, std::size_t at) const {
    const std::size_t upper = text_.find(type, at);
    if (upper != string_view::npos) return upper;
    return text_.find(geometry::lower_case(type), at);
  }

  std::optional<string_view> arguments_at(std::size_t at, string_view type) const {
    at = text_.find_first_not_of(" \t\r\n", at);
    if (at == string_view::npos) return std::nullopt;
    const std::size_t open = text_.find('(', at);
    if (open == string_view::npos) return std::nullopt;
    const std::string name = geometry::lower_case(geometry::trimmed(text_.substr(at, open - at)));
    if (!type.empty() && name != geometry::lower_case(type)) return std::nullopt;
    const std::size_t end = text_.find(';', open);
    const std::size_t close = text_.rfind(')', end == string_view::npos ? text_.size() : end);
    if (close == string_view::npos || close < open) return std::nullopt;
    return text_.substr(open + 1, close - open - 1);
  }

  string_view text_;
};

/// Splits arguments at commas outside parentheses and strings.
std::vector<std::string> split(string_view arguments) {
  std::vector<std::string> parts(1);
  int depth = 0;
  bool is_text = false;
  for (const char c : arguments) {
    if (c == '\'') is_text = !is_text;
    if (!is_text && c == '(') ++depth;
    if (!is_text && c == ')') --depth;
    if (!is_text && depth == 0 && c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  for (std::string& part : parts) part = std::string(geometry::trimmed(part));
  return parts;
}

/// Returns the references in a text, such as "#12".
std::vector<std::string> references_in(string_view text) {
  std::vector<std::string> references;
  for (std::size_t at = text.find('#'); at != string_view::npos; at = text.find('#', at + 1)) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789", at + 1), text.size());
    references.emplace_back(text.substr(at, end - at));
  }
  return references;
}

std::optional<double> number_within(const std::string& text) {
  // After the parenthesis of "IFCLENGTHMEASURE(0.3048)", or 0.
  const std::size_t begin = text.find('(') + 1;
  const std::string number(geometry::trimmed(text.substr(begin, text.find(')') - begin)));
  std::string plain = number;
  if (plain.ends_with('.')) plain.pop_back();
  return geometry::number_in(plain);
}

std::optional<double> find_metric_prefix(const std::string& name) {
  struct Prefix {
    const char* name;
    double factor;
  };
  constexpr std::array<Prefix, 9> prefixes{{{"$", 1.0},
                                            {".MILLI.", 1e-3},
                                            {".CENTI.", 1e-2},
                                            {".DECI.", 0.1},
                                            {".DECA.", 10.0},
                                            {".HECTO.", 100.0},
                                            {".KILO.", 1e3},
                                            {".MICRO.", 1e-6},
                                            {".NANO.", 1e-9}}};
  const auto prefix = std::ranges::find(prefixes, name, &Prefix::name);
  if (prefix == prefixes.end()) return std::nullopt;
  return prefix->factor;
}

/// Returns the length of an IfcSIUnit [m].
std::optional<double> si_length(const Entities& entities, const std::string& reference) {
  const auto arguments = entities.arguments(reference, "IFCSIUNIT");
  if (!arguments) return std::nullopt;
  const std::vector<std::string> parts = split(*arguments);
  if (parts.size() != 4 || parts[1] != ".LENGTHUNIT." || parts[3] != ".METRE.") return std::nullopt;
  return find_metric_prefix(parts[2]);
}

/// Linear unit of an IFC file.
struct LengthUnit {
  bool is_si = false;            ///< SI unit, which Assimp applies.
  std::optional<double> metres;  ///< Length of other units.
  std::string name;
};

std::optional<LengthUnit> length_unit(const Entities& entities) {
  const auto assignment = entities.first("IFCUNITASSIGNMENT");
  if (!assignment) return std::nullopt;
  for (const std::string& reference : references_in(*assignment)) {
    if (si_length(entities, reference)) return LengthUnit{true, {}, "metre"};
    const auto conversion = entities.arguments(reference, "IFCCONVERSIONBASEDUNIT");
    if (!conversion) continue;
    const std::vector<std::string> parts = split(*conversion);
    if (parts.size() != 4 || parts[1] != ".LENGTHUNIT.") continue;
    LengthUnit unit{false, {}, parts[2].substr(0, 40)};
    std::erase(unit.name, '\'');
    const auto measure = entities.arguments(parts[3], "IFCMEASUREWITHUNIT");
    if (!measure) return unit;
    const std::vector<std::string> factor = split(*measure);
    if (factor.size() != 2) return unit;
    const auto number = number_within(factor[0]);
    const auto base = si_length(entities, factor[1]);
    if (number && base && *number > 0.0) unit.metres = *number * *base;
    return unit;
  }
  return std::nullopt;
}

void note_map_conversion(const Entities& entities, SceneFacts& facts) {
  const auto conversion = entities.first("IFCMAPCONVERSION");
  if (!conversion) return;
  const std::vector<std::string> parts = split(*conversion);
  if (parts.size() < 5) return;
  std::string system = "an unnamed system";
  if (const auto target = entities.arguments(parts[1], "IFCPROJECTEDCRS")) {
    system = split(*target)[0];
    std::erase(system, '\'');
  }
  const auto number = [](const std::string& text) {
    return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
  };
  const bool is_turned = parts.size() > 6 && parts[5] != "$" && number_within(parts[6]) != 0.0;
  facts.notes.push_back(one_line(
      "it contains a georeference (IfcMapConversion), which is not applied: its origin is at " +
      number(parts[2]) + " " + number(parts[3]) + " " + number(parts[4]) + " in " + system +
      (is_turned ? ", rotated relative to the map; set place"
                 : "; set crs, vertical and offset, or place")));
}

}  // namespace

SceneFacts gltf_facts(const std::filesystem::path& file, string_view json) {
  SceneFacts facts;
  const Json root = geometry::parse_json<Json>(geometry::without_mark(json));
  if (root.is_discarded() || !root.is_object()) return facts;  // Assimp reports the error.
  for (const std::string& name : names_in(root, "extensionsRequired")) {
    if (!is_harmless(name)) reject_extension(file, name);
  }
  for (const std::string& name : names_in(root, "extensionsUsed")) {
    if (is_deciding(name)) reject_extension(file, name);
  }
  if (const auto own = root.find("extensions"); own != root.end() && own->contains("CESIUM_RTC")) {
    reject_extension(file, "CESIUM_RTC");
  }
  const auto scenes = root.find("scenes");
  if (scenes != root.end() && scenes->is_array() && scenes->size() > 1) {
    facts.notes.push_back("it contains " + std::to_string(scenes->size()) +
                          " scenes; only the default scene is read");
  }
  return facts;
}

SceneFacts ifc_facts(const std::filesystem::path& file, string_view text, bool has_unit) {
  SceneFacts facts;
  const Entities entities(text);
  const std::optional<LengthUnit> unit = length_unit(entities);
  if (!has_unit && (!unit || (!unit->is_si && !unit->metres))) {
    fail_file(file, (unit ? "has an unknown linear unit: '" + unit->name + "'"
                          : std::string("has no linear unit")) +
                        "; set unit to the length of one unit in metres");
  }
  if (unit && !unit->is_si && unit->metres) {
    facts.unit = unit->metres;
    facts.notes.push_back(one_line("linear unit: the " + geometry::lower_case(unit->name) + ", " +
                                   Json(*unit->metres).dump() + " m"));
  }
  note_map_conversion(entities, facts);
  // IFC2X3 uses this property set for the georeference.
  if (geometry::lower_case(text).find("'epset_mapconversion'") != std::string::npos) {
    facts.notes.emplace_back(
        "it contains a georeference (ePset_MapConversion), which is not supported; set place");
  }
  return facts;
}

std::string gltf_json(const std::filesystem::path& file) {
  std::ifstream stream = geometry::open_stream(file);
  std::string head(20, '\0');
  stream.read(head.data(), std::ssize(head));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  if (!head.starts_with("glTF")) return geometry::as_utf8(geometry::read_file(file));
  if (head.size() < 20) return {};
  const auto length = geometry::value_at<std::uint32_t>(head.data(), 12);
  std::error_code failure;
  if (length > std::filesystem::file_size(file, failure) || failure) return {};
  std::string json(length, '\0');
  stream.read(json.data(), std::ssize(json));
  json.resize(static_cast<std::size_t>(stream.gcount()));
  return json;
}

}  // namespace skycap::missions::site_data
