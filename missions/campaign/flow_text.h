/// Values of YAML in one line.
#pragma once

#include <string>

#include "missions/file/yaml_tree.h"

namespace skycap::missions::campaign {

/// A text that parse_yaml() reads as the same value, lines aside.
std::string flow_text(const file::YamlNode& node);

}  // namespace skycap::missions::campaign
