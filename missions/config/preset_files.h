/// The texts of the descriptions that come with the program: sim/sensors/presets/*.yaml and
/// flight/motion/presets/*.yaml.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace skycap::missions::config {

struct PresetFile {
  std::string_view name;  ///< of the file, without its extension
  std::string_view text;
};

/// In alphabetical order.
std::span<const PresetFile> sensor_preset_files();
std::span<const PresetFile> vehicle_preset_files();

struct PresetText {
  std::string text;
  std::string file;  ///< what messages call it
};

/// A name that a mission gives: that of a preset, or a path that counts from the mission's folder.
std::string named_from(const std::filesystem::path& folder, const std::string& name);

/// The preset of that name, or what the file of that path holds if it ends in .yaml. Throws
/// Error{bad_config} with the known names, saying what `kind` of thing they are, or
/// Error{bad_file}.
PresetText preset_text(const std::string& kind, const std::string& name_or_file,
                       std::span<const PresetFile> presets);

}  // namespace skycap::missions::config
