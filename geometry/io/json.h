/// The one way in for JSON of foreign origin.
#pragma once

#include <cstddef>
#include <string_view>

namespace skycap::geometry {

/// Of JSON that is read whole [byte]: its tree takes up to twenty times as much.
inline constexpr std::size_t largest_json = std::size_t{64} << 20;

/// Whether lists and objects in a JSON text are nested deeper than anything we read needs. Parsers
/// and destructors of JSON call themselves for each level: a long row of brackets is a crash.
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

/// The value of a JSON text, of whichever of nlohmann's types; `is_discarded()` if the text is not
/// JSON or is nested deeper than 64.
template <typename Json>
Json parse_json(std::string_view text) {
  if (is_nested_too_deep(text)) return Json(Json::value_t::discarded);
  return Json::parse(text.begin(), text.end(), nullptr, false);
}

}  // namespace skycap::geometry
