/// A YAML file as a tree that remembers its lines. The part of YAML that mission files need: one
/// document of maps, lists and scalars, without anchors, aliases and tags.
#pragma once

#include <string>
#include <vector>

namespace skycap::missions::support {

struct YamlEntry;

struct YamlNode {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  int line = 1;                    ///< counted from one
  std::string text;                ///< of a scalar
  bool is_quoted = false;          ///< a scalar in quotes is text, whatever it looks like
  std::vector<YamlNode> items;     ///< of a list
  std::vector<YamlEntry> entries;  ///< of a map, in the order of the file; keys are unique
};

struct YamlEntry {
  std::string key;
  int line = 1;
  YamlNode value;
};

/// Parses `text`. Throws Error{bad_config} with the message "NAME:LINE: what is wrong" if it is
/// broken, is nested more than 16 deep, repeats a key, or uses what is left out.
YamlNode parse_yaml(const std::string& text, const std::string& name);

}  // namespace skycap::missions::support
