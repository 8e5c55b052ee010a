/// Identification of surveys and scans.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace skycap::missions::support {

/// A mission key that affects the survey or scan, with its value.
struct Setting {
  std::string key;
  std::string value;  ///< value in mission-file notation; "-" if it is derived
};

/// Inputs that identify a survey or scan. They must be equal for an unfinished one to be resumed.
struct Identity {
  std::uint64_t seed = 1;
  std::vector<Setting> settings;  ///< all keys except name, seed and threads, in table order
};

}  // namespace skycap::missions::support
