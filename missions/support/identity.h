/// What tells one survey or scan from another.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace skycap::missions::support {

/// A key that decides how a survey or a scan goes, as text.
struct Setting {
  std::string key;
  std::string value;  ///< as a mission file would say it; "-" if it is left to be derived
};

/// What tells a survey or a scan from others: what an unfinished one has to be continued with.
struct Identity {
  std::uint64_t seed = 1;
  std::vector<Setting> settings;  ///< all keys but name, seed and threads, in their order
};

}  // namespace skycap::missions::support
