/// The texts of sim/sensors/presets/*.yaml.
#pragma once

#include <string_view>
#include <vector>

namespace skycap::missions::file {

/// A description that comes with the program.
struct PresetFile {
  std::string_view name;  ///< of the file, without its extension
  std::string_view text;
};

/// In alphabetical order.
const std::vector<PresetFile>& preset_files();

}  // namespace skycap::missions::file
