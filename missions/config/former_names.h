/// Key and value names of version 0.1 that version 0.2 still accepts. They will be removed in 0.3.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/support/yaml_tree.h"

namespace skycap::missions::config {

/// A former name in a file and its replacement.
struct FormerName {
  int line = 1;        ///< line number in the file, from 1
  std::string former;  ///< key, or "KEY: VALUE" for a former value
  std::string current;
};

/// Returns the current path of a key or section: "planner.ideas.dose" becomes
/// "planner.ablation.coverage_model". Other paths are returned unchanged.
std::string current_path(std::string_view path);

/// Returns the current name of a benchmark planner: "omniscient" becomes "oracle".
std::string_view current_planner(std::string_view name);

/// Replaces former keys and values in a mission tree with the current ones. `path` is the key of
/// `node`; it is empty for a whole mission. Returns the replacements in file order. Throws
/// Error{bad_config}, prefixed with `name` and the line, if a key is given under both names.
std::vector<FormerName> replace_former_names(support::YamlNode& node, const std::string& path,
                                             const std::string& name);

/// Replaces former names in a campaign or district file, including its overrides of mission keys.
/// Returns and throws as replace_former_names().
std::vector<FormerName> replace_former_batch_names(support::YamlNode& node,
                                                   const std::string& name);

/// Returns the former names in command-line overrides, such as --set planner.min_gain=0.01.
std::vector<FormerName> former_names_in(std::span<const KeyOverride> overrides);

/// Returns the text of a mission file with current names; comments and layout are preserved. Throws
/// Error{bad_config} if the text is not a YAML map. It also throws if a line contains several keys
/// of the name, so that the replacement is ambiguous.
std::string with_current_names(const std::string& text, const std::string& name);

/// Returns a one-line list of renamings, such as "planner.min_gain is now planner.min_gain".
std::string to_string(std::span<const FormerName> names);

}  // namespace skycap::missions::config
