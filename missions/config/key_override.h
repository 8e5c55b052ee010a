/// Override of a mission key from outside the mission file.
#pragma once

#include <string>

namespace skycap::missions::config {

/// Value that replaces a key's value in the file, such as --seed 3.
struct KeyOverride {
  std::string origin;  ///< source named in messages, such as "--seed"
  std::string path;    ///< key path, such as "seed"
  std::string value;   ///< value in YAML notation, as in a mission file
  /// Whether the user of this run states the value, on the command line or in a program. Overrides
  /// read from files do not: planner.file names code, which only the user may choose to execute.
  bool is_by_user = false;
};

}  // namespace skycap::missions::config
