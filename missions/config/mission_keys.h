/// Every key of the mission file, in one table: the reader, the JSON Schema and the page
/// docs/reference/mission-file.md are all made from it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "missions/config/key.h"

namespace skycap::missions::config {

/// All keys, those of a section together.
std::span<const Key> mission_keys();

/// The key with that path, or null.
const Key* find_key(std::string_view path);

/// The words for what a key takes, such as "a number above 0".
std::string expected_value(const Key& key);

/// A value as a mission file would say it.
std::string to_text(const KeyValue& value);

/// The JSON Schema of the mission file, for editors: missions/mission.schema.json.
std::string mission_json_schema();

/// The table of keys of docs/reference/mission-file.md.
std::string mission_key_table();

}  // namespace skycap::missions::config
