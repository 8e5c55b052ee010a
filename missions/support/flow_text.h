/// Values of YAML in one line.
#pragma once

#include <string>
#include <string_view>

#include "missions/support/yaml_tree.h"

namespace skycap::missions::support {

/// A text in quotes, in which nothing means anything to YAML.
std::string yaml_quoted(std::string_view text);

/// A text that parse_yaml() reads as the same value, lines aside.
std::string flow_text(const YamlNode& node);

}  // namespace skycap::missions::support
