/// The texts of sim/sensors/*.yaml.
#pragma once

#include <string_view>
#include <vector>

namespace skycap::missions {

struct SensorPreset {
  std::string_view name;  ///< of the file, without its extension
  std::string_view text;
};

/// In alphabetical order.
const std::vector<SensorPreset>& preset_files();

}  // namespace skycap::missions
