/// Writes YAML values in one line (flow style).
#pragma once

#include <string>
#include <string_view>

#include "missions/support/yaml_tree.h"

namespace skycap::missions::support {

/// Returns a quoted YAML string with all special characters escaped.
std::string yaml_quoted(std::string_view text);

/// Returns a string that parse_yaml() reads as the same value, except for line numbers.
std::string flow_text(const YamlNode& node);

}  // namespace skycap::missions::support
