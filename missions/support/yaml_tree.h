/// YAML tree with line numbers. It supports the subset of YAML required by mission files: one
/// document of maps, lists and scalars, without anchors, aliases and tags.
#pragma once

#include <string>
#include <vector>

namespace skycap::missions::support {

struct YamlEntry;

struct YamlNode {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  int line = 1;                    ///< line number, from 1
  std::string text;                ///< value of a scalar
  bool is_quoted = false;          ///< quoted scalars are always strings
  std::vector<YamlNode> items;     ///< elements of a list
  std::vector<YamlEntry> entries;  ///< entries of a map in file order; keys are unique
};

struct YamlEntry {
  std::string key;
  int line = 1;
  YamlNode value;
};

/// Parses YAML. Throws Error{bad_config} with the message "NAME:LINE: what is wrong". Errors are
/// invalid syntax, nesting deeper than 16 levels, duplicate keys and unsupported features.
YamlNode parse_yaml(const std::string& text, const std::string& name);

}  // namespace skycap::missions::support
