#include "missions/site_data/formats/map_tags.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <vector>

namespace skycap::missions::site_data {

void add_tags(const std::string& text, std::map<std::string, std::string>& attributes) {
  std::vector<std::string> quoted;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '"') continue;
    std::string& part = quoted.emplace_back();
    for (++i; i < text.size() && text[i] != '"'; ++i) {
      if (text[i] == '\\' && i + 1 < text.size()) ++i;
      part += text[i];
    }
  }
  for (std::size_t i = 0; i + 1 < quoted.size(); i += 2)
    attributes.emplace(quoted[i], quoted[i + 1]);
}

namespace {

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

double numeric_tag(const FileObject& object, const char* key) {
  const auto found = object.attributes.find(key);
  double number = 0.0;
  if (found != object.attributes.end()) {
    const char* const begin = found->second.data();
    std::from_chars(begin, begin + found->second.size(), number);
  }
  return std::isfinite(number) ? number : 0.0;
}

bool has_tag(const FileObject& object, const char* key) {
  const auto found = object.attributes.find(key);
  return found != object.attributes.end() && !found->second.empty() && found->second != "no";
}

bool may_state_height(const FileObject& object) {
  return std::ranges::any_of(object.attributes, [](const auto& attribute) {
    const std::string key = lower_case(attribute.first);
    return !attribute.second.empty() && (key.find("height") != std::string::npos || key == "hoehe");
  });
}

bool is_structure(const FileObject& object) {
  const auto building = object.attributes.find("building");
  if (building != object.attributes.end() && building->second == "no") return false;
  return has_tag(object, "building") || has_tag(object, "building:part") ||
         has_tag(object, "man_made") || has_tag(object, "power") || may_state_height(object);
}

bool is_cable(const FileObject& object) {
  const auto power = object.attributes.find("power");
  const bool is_power_line =
      power != object.attributes.end() &&
      (power->second == "line" || power->second == "minor_line" || power->second == "cable");
  return is_power_line || has_tag(object, "aerialway");
}

}  // namespace skycap::missions::site_data
