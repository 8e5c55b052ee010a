#include "missions/site_data/formats/building_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "geometry/io/text/plain_text.h"

namespace skycap::missions::site_data {
namespace {

using std::string_view;

constexpr double storey =
    3.0;  ///< Assumed height of a storey if only the number of storeys is known [m].
constexpr double foot = 0.3048, inch = 0.0254;

/// Maximum length of attribute names in Shapefiles, which other formats often retain.
constexpr std::size_t longest_shapefile_name = 10;

/// Number at the start of a text and the following text without leading spaces.
struct Quantity {
  double number = 0.0;
  string_view rest;
};

std::optional<Quantity> parse_quantity(string_view text) {
  text = geometry::trimmed(text);
  std::size_t end = 0;
  while (end < text.size() &&
         (std::isdigit(static_cast<unsigned char>(text[end])) != 0 || text[end] == '.' ||
          text[end] == ',' || (end == 0 && (text[end] == '-' || text[end] == '+')))) {
    ++end;
  }
  const std::optional<double> number = geometry::number_with_comma(text.substr(0, end));
  if (!number || !std::isfinite(*number)) return std::nullopt;
  return Quantity{*number, geometry::trimmed(text.substr(end))};
}

/// Returns the length of a unit in metres, or an empty value for unknown names. An empty name
/// stands for metres.
std::optional<double> find_metres_per_unit(string_view name) {
  std::string unit = geometry::lower_case(name);
  std::erase(unit, '.');
  for (const string_view metre : {"", "m", "meter", "meters", "metre", "metres", "mtr"}) {
    if (unit == metre) return 1.0;
  }
  for (const string_view feet : {"ft", "foot", "feet", "'", "\xE2\x80\xB2", "\xE2\x80\x99"}) {
    if (unit == feet) return foot;
  }
  for (const string_view inches : {"in", "inch", "inches", "\"", "\xE2\x80\xB3", "''"}) {
    if (unit == inches) return inch;
  }
  if (unit == "cm") return 0.01;
  if (unit == "mm") return 0.001;
  if (unit == "km") return 1000.0;
  return std::nullopt;
}

/// Parses "7'4\"" and "7 ft 4 in".
std::optional<double> feet_and_inches(string_view text) {
  const std::size_t mark = text.find_first_of("'f");
  if (mark == string_view::npos) return std::nullopt;
  const std::optional<Quantity> feet = parse_quantity(text.substr(0, mark));
  if (!feet || !feet->rest.empty()) return std::nullopt;
  string_view rest = text.substr(mark);
  for (const string_view name : {"feet", "foot", "ft", "'"}) {
    if (!rest.starts_with(name)) continue;
    rest.remove_prefix(name.size());
    const std::optional<Quantity> inches = parse_quantity(rest);
    if (!inches) return std::nullopt;
    const std::optional<double> unit = find_metres_per_unit(inches->rest);
    if (!inches->rest.empty() && unit != inch) return std::nullopt;
    return feet->number * foot + inches->number * inch;
  }
  return std::nullopt;
}

std::optional<double> one_length(string_view text) {
  text = geometry::trimmed(text);
  if (const std::optional<Quantity> quantity = parse_quantity(text)) {
    if (const std::optional<double> unit = find_metres_per_unit(quantity->rest)) {
      return quantity->number * *unit;
    }
    // In a range, only the second number may have a unit.
    if (quantity->rest.starts_with('-') || quantity->rest.starts_with("\xE2\x80\x93")) {
      const std::size_t dash = quantity->rest.starts_with('-') ? 1 : 3;
      const std::optional<Quantity> max = parse_quantity(quantity->rest.substr(dash));
      const std::optional<double> unit = max ? find_metres_per_unit(max->rest) : std::nullopt;
      if (unit) return std::max(quantity->number, max->number) * *unit;
    }
  }
  return feet_and_inches(text);
}

/// Returns the maximum of a list, or an empty value if an entry cannot be parsed.
std::optional<double> find_max_value(
    string_view text, const std::function<std::optional<double>(string_view)>& read) {
  std::optional<double> max_height;
  while (true) {
    const std::size_t end = std::min(text.find_first_of(";|"), text.size());
    const string_view part = geometry::trimmed(text.substr(0, end));
    if (!part.empty()) {
      const std::optional<double> value = read(part);
      if (!value) return std::nullopt;
      max_height = std::max(max_height.value_or(*value), *value);
    }
    if (end == text.size()) return max_height;
    text.remove_prefix(end + 1);
  }
}

std::optional<double> one_count(string_view text) {
  double sum = 0.0;
  while (true) {
    const std::size_t plus = std::min(text.find('+', 1), text.size());
    const std::optional<Quantity> part = parse_quantity(text.substr(0, plus));
    if (!part) return std::nullopt;
    if (!part->rest.empty()) {  // For example "2-3".
      if (plus != text.size() || !part->rest.starts_with('-')) return std::nullopt;
      const std::optional<Quantity> max = parse_quantity(part->rest.substr(1));
      if (!max || !max->rest.empty()) return std::nullopt;
      return std::max(part->number, max->number);
    }
    sum += part->number;
    if (plus == text.size()) return sum;
    text.remove_prefix(plus + 1);
  }
}

/// Converts a name to lower case with one separator between words.
std::string plain_name(string_view name) {
  std::string plain = geometry::lower_case(name);
  for (char& c : plain) {
    if (c == ':' || c == ' ' || c == '-') c = '_';
  }
  return plain;
}

/// Name and value of the first non-empty attribute.
struct Found {
  std::string name, value;
};

class HeightReader {
 public:
  HeightReader(FileContents& contents, std::string height_attribute)
      : contents_(contents), height_attribute_(std::move(height_attribute)) {}

  void read() {
    for (FileObject& object : contents_.objects) {
      if (object.polygons.empty()) continue;
      read_min_height(object);
      read_height(object);
    }
    const auto is_nothing = [](const FileObject& object) {
      return object.is_thin && !object.height && !object.reaches_ground &&
             object.height_problem.empty();
    };
    thin_ = std::erase_if(contents_.objects, is_nothing);
    add_notes();
  }

 private:
  /// Finds the attribute with one of the names, in any spelling or truncated by a Shapefile.
  std::optional<Found> find(const FileObject& object, std::span<const string_view> names) const {
    for (const string_view name : names) {
      for (const auto& [key, value] : object.attributes) {
        if (geometry::trimmed(value).empty()) continue;
        const std::string plain = plain_name(key);
        const bool is_cut = plain.size() == longest_shapefile_name && name.starts_with(plain);
        if (plain == name || is_cut) return Found{key, value};
      }
    }
    return std::nullopt;
  }

  void read_height(FileObject& object) {
    if (object.height) {
      ++by_height_;
      return;
    }
    constexpr std::array<string_view, 6> usual{"height",      "building_height", "est_height",
                                               "bldg_height", "hoehe",           "max_height"};
    const std::optional<Found> height =
        height_attribute_.empty() ? find(object, usual) : find_configured(object);
    if (height) {
      const std::optional<double> metres = parse_metres(height->value);
      if (!metres) {
        object.height_problem = "has the " + height->name + " '" + height->value.substr(0, 60) +
                                "', which is not a height in metres or feet";
        return;
      }
      if (*metres > 0.0) {
        object.height = *metres;
        ++by_height_;
        return;
      }
      ++without_meaning_;  // -1 and 0 stand for unknown.
    }
    read_storeys(object);
  }

  std::optional<Found> find_configured(const FileObject& object) const {
    const auto found = object.attributes.find(height_attribute_);
    if (found == object.attributes.end() || geometry::trimmed(found->second).empty()) {
      return std::nullopt;
    }
    return Found{found->first, found->second};
  }

  void read_storeys(FileObject& object) {
    constexpr std::array<string_view, 4> storeys{"building_levels", "num_floors", "levels",
                                                 "building_floors"};
    constexpr std::array<string_view, 1> roof_height{"roof_height"}, roof_levels{"roof_levels"};
    const std::optional<Found> levels = find(object, storeys);
    if (!levels) return;
    const std::optional<double> count = parse_storeys(levels->value);
    if (!count) {
      object.height_problem = "has the " + levels->name + " '" + levels->value.substr(0, 60) +
                              "', which is not a number of storeys";
      return;
    }
    double roof = 0.0;
    if (const auto found = find(object, roof_height)) {
      const std::optional<double> metres = parse_metres(found->value);
      if (!metres) {
        object.height_problem = "has the " + found->name + " '" + found->value.substr(0, 60) +
                                "', which is not a height in metres or feet";
        return;
      }
      roof = std::max(0.0, *metres);
    } else if (const auto in_roof = find(object, roof_levels)) {
      const std::optional<double> more = parse_storeys(in_roof->value);
      if (!more) {
        object.height_problem = "has the " + in_roof->name + " '" + in_roof->value.substr(0, 60) +
                                "', which is not a number of storeys";
        return;
      }
      roof = storey * std::max(0.0, *more);
    }
    if (!(*count > 0.0) && !(roof > 0.0)) {
      ++without_meaning_;
      return;
    }
    object.height = storey * std::max(0.0, *count) + roof;
    ++by_levels_;
    if (roof > 0.0) ++with_roof_;
  }

  void read_min_height(FileObject& object) {
    if (object.min_height) return;
    constexpr std::array<string_view, 2> heights{"min_height", "building_min_height"};
    constexpr std::array<string_view, 2> levels{"building_min_level", "min_level"};
    if (const auto found = find(object, heights)) {
      object.min_height = parse_metres(found->value);
      if (!object.min_height) ++without_min_;
    } else if (const auto level = find(object, levels)) {
      // In Shapefiles, "building_m" may also be an abbreviation of the material.
      const std::optional<double> count = parse_storeys(level->value);
      if (count) object.min_height = storey * *count;
    }
    if (object.min_height && *object.min_height < 0.0) object.min_height = 0.0;
  }

  void add_notes() const {
    const auto add = [&](std::size_t count, const char* what) {
      if (count > 0) contents_.notes.push_back(std::to_string(count) + what);
    };
    add(thin_, " points and lines ignored (unknown height)");
    add(by_height_, " outlines specify a height");
    add(by_levels_, " outlines specify only a number of storeys; 3 m per storey are assumed");
    add(with_roof_, " of these have a roof above their storeys; its height is added");
    add(without_meaning_, " outlines have a height of 0 or less, which is treated as unknown");
    add(without_min_, " outlines have an invalid min_height; they start at their base");
  }

  FileContents& contents_;
  std::string height_attribute_;
  std::size_t by_height_ = 0, by_levels_ = 0, with_roof_ = 0, without_meaning_ = 0,
              without_min_ = 0, thin_ = 0;
};

}  // namespace

std::optional<double> parse_metres(string_view text) { return find_max_value(text, one_length); }

std::optional<double> parse_storeys(string_view text) { return find_max_value(text, one_count); }

void read_building_heights(FileContents& contents, const std::string& height_attribute) {
  HeightReader(contents, height_attribute).read();
}

std::string attribute_names(const FileObject& object) {
  constexpr std::size_t max = 12;
  std::string names;
  std::size_t count = 0;
  for (const auto& [name, value] : object.attributes) {
    if (++count > max) return names + ", ...";
    names += (names.empty() ? "" : ", ") + one_line(name.substr(0, 40));
  }
  return names.empty() ? "none" : names;
}

}  // namespace skycap::missions::site_data
