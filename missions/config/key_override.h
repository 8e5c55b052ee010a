/// A change to a mission from outside of its file.
#pragma once

#include <string>

namespace skycap::missions::config {

/// A value given beside the file that takes the place of the file's, such as --seed 3.
struct KeyOverride {
  std::string origin;  ///< what messages call it, such as "--seed"
  std::string path;    ///< the key, such as "seed"
  std::string value;   ///< as the file would say it
};

}  // namespace skycap::missions::config
