/// Keys of mission files that another file changes in all of its missions.
#pragma once

#include <string>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/support/yaml_tree.h"

namespace skycap::missions::batch {

/// Keys that follow from the file that makes the changes, and what to give in their place.
struct FollowingKeys {
  std::vector<std::string> keys;  ///< one that ends with a dot stands for its section
  std::string instead;            ///< "the campaign; give ..."

  bool holds(const std::string& key) const;
};

/// The changes in `entries` of the file `file`, each key written out or nested as in a mission
/// file; `path`, such as "set.", goes before them in messages. Throws Error{bad_config},
/// "FILE:LINE: key KEY ...", for one that is unknown or `following`.
std::vector<config::KeyOverride> key_changes(const std::vector<support::YamlEntry>& entries,
                                             const std::string& path, const std::string& file,
                                             const FollowingKeys& following);

}  // namespace skycap::missions::batch
