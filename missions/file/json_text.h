#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace skycap::missions::file {

/// A JSON file's text. Names that are not valid UTF-8 are shown with a replacement character.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace skycap::missions::file
