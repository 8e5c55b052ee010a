/// The texts of the descriptions that come with the program: sim/sensors/presets/*.yaml,
/// flight/motion/presets/*.yaml and survey/photo/presets/*.yaml.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace skycap::missions::config {

struct PresetFile {
  std::string_view name;  ///< file name without extension
  std::string_view text;
};

/// Return the presets in alphabetical order.
std::span<const PresetFile> sensor_preset_files();
std::span<const PresetFile> vehicle_preset_files();
std::span<const PresetFile> photo_camera_preset_files();

struct PresetText {
  std::string text;
  std::string file;  ///< file name in messages
};

/// Resolves a name from a mission file: preset names are unchanged, and paths are relative to the
/// mission's folder.
std::string named_from(const std::filesystem::path& folder, const std::string& name);

/// Returns the preset with the given name, or the contents of a file if the name ends in .yaml.
/// Throws Error{bad_config} with a list of known names for an unknown preset; `kind` is the noun in
/// this message. Throws Error{bad_file} if the file cannot be read.
PresetText preset_text(const std::string& kind, const std::string& name_or_file,
                       std::span<const PresetFile> presets);

}  // namespace skycap::missions::config
