/// Parser for JSON from external sources. All such JSON must be parsed with it.
#pragma once

#include <cstddef>
#include <string_view>

namespace skycap::geometry {

/// Maximum size of a JSON file [bytes]. The parsed tree needs up to twenty times as much memory.
inline constexpr std::size_t largest_json = std::size_t{64} << 20;

/// Returns whether lists and objects are nested deeper than any supported format requires. JSON
/// parsers and destructors are recursive, so that deeply nested brackets would overflow the stack.
inline bool is_nested_too_deep(std::string_view json) {
  constexpr int deepest = 64;
  int depth = 0;
  bool is_in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (is_in_string) {
      if (c == '\\') ++i;
      if (c == '"') is_in_string = false;
    } else if (c == '"') {
      is_in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > deepest) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

/// Parses JSON into one of the types of nlohmann/json. `is_discarded()` is true if the text is not
/// valid JSON or is nested deeper than 64 levels.
template <typename Json>
Json parse_json(std::string_view text) {
  if (is_nested_too_deep(text)) return Json(Json::value_t::discarded);
  return Json::parse(text.begin(), text.end(), nullptr, false);
}

}  // namespace skycap::geometry
