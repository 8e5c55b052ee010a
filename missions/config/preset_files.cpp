#include "missions/config/preset_files.h"

#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::missions::config {

std::string named_from(const std::filesystem::path& folder, const std::string& name) {
  return name.ends_with(".yaml") ? (folder / name).string() : name;
}

PresetText preset_text(const std::string& kind, const std::string& name_or_file,
                       std::span<const PresetFile> presets) {
  if (name_or_file.ends_with(".yaml")) {
    constexpr std::size_t largest = 1 << 20;  // [byte]; descriptions have about a thousand
    const std::string text = geometry::read_file(name_or_file, largest);
    if (text.empty()) throw Error(ErrorKind::bad_file, name_or_file + ": is empty");
    return {text, name_or_file};
  }
  std::string known;
  for (const PresetFile& preset : presets) {
    if (preset.name == name_or_file) return {std::string(preset.text), name_or_file + ".yaml"};
    known += (known.empty() ? "" : ", ") + std::string(preset.name);
  }
  constexpr std::size_t longest = 60;  // of names in messages
  const std::string named =
      name_or_file.size() <= longest ? name_or_file : name_or_file.substr(0, longest) + "...";
  throw Error(ErrorKind::bad_config, "unknown " + kind + " " + named +
                                         "; expected one of: " + known + ", or a file NAME.yaml");
}

}  // namespace skycap::missions::config
