/// Names of version 0.1 that version 0.2 accepts for its keys and their values. Removed with 0.3.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/support/yaml_tree.h"

namespace skycap::missions::config {

/// A name that was found, and the current name.
struct FormerName {
  int line = 1;        ///< of the file, counted from one
  std::string former;  ///< a key, or "KEY: VALUE"
  std::string current;
};

/// The current path of a key, or of a section: "planner.ideas.dose" is
/// "planner.ablation.coverage_model". Paths that are not former are returned as they are.
std::string current_path(std::string_view path);

/// The current name of a planner of benchmarks: "oracle" for "omniscient".
std::string_view current_planner(std::string_view name);

/// Replaces the former keys and values of a mission by the current ones; `path` is the key whose
/// value `node` is, empty for a whole mission. Returns what was replaced, in the order of the file.
/// Throws Error{bad_config}, beginning with `name` and the line, if a key is given by both of its
/// names.
std::vector<FormerName> replace_former_names(support::YamlNode& node, const std::string& path,
                                             const std::string& name);

/// The same of a campaign or district file, whose changes to the missions' keys are among them.
std::vector<FormerName> replace_former_batch_names(support::YamlNode& node,
                                                   const std::string& name);

/// The former names in overrides, such as --set planner.least_gain=0.01.
std::vector<FormerName> former_names_in(std::span<const KeyOverride> overrides);

/// The text of a mission file with current names; all else, comments and layout too, is kept.
/// Throws Error{bad_config} if the text is not a YAML map, or if a name cannot be replaced because
/// several keys of the same name are in its line.
std::string with_current_names(const std::string& text, const std::string& name);

/// One line that lists names, such as "planner.least_gain is now planner.min_gain".
std::string text_of(std::span<const FormerName> names);

}  // namespace skycap::missions::config
