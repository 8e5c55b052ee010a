/// Table of all mission keys. The reader, the JSON Schema and docs/reference/mission-file.md are
/// generated from it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "missions/config/key.h"

namespace skycap::missions::config {

/// Returns all keys, grouped by section.
std::span<const Key> mission_keys();

/// Returns the key with the given path, or null.
const Key* find_key(std::string_view path);

/// Returns a description of permitted values, such as "a number above 0".
std::string expected_value(const Key& key);

/// Formats a value in the notation of a mission file.
std::string to_text(const KeyValue& value);

/// Returns the JSON Schema of the mission file for editors (missions/mission.schema.json).
std::string mission_json_schema();

/// Returns the key table of docs/reference/mission-file.md.
std::string mission_key_table();

}  // namespace skycap::missions::config
