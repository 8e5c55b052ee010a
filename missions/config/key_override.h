/// Override of a mission key from outside the mission file.
#pragma once

#include <string>

namespace skycap::missions::config {

/// Value that replaces a key's value in the file, such as --seed 3.
struct KeyOverride {
  std::string origin;  ///< source named in messages, such as "--seed"
  std::string path;    ///< key path, such as "seed"
  std::string value;   ///< value in YAML notation, as in a mission file
};

}  // namespace skycap::missions::config
