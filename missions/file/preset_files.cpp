#include "missions/file/preset_files.h"

#include <fstream>
#include <iterator>

#include "geometry/error.h"

namespace skycap::missions::file {

PresetText preset_text(const std::string& kind, const std::string& name_or_file,
                       std::span<const PresetFile> presets) {
  if (name_or_file.ends_with(".yaml")) {
    std::ifstream file(name_or_file);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file || text.empty()) {
      throw Error(ErrorKind::bad_file, name_or_file + ": cannot be read, or is empty");
    }
    return {text, name_or_file};
  }
  std::string known;
  for (const PresetFile& preset : presets) {
    if (preset.name == name_or_file) return {std::string(preset.text), name_or_file + ".yaml"};
    known += (known.empty() ? "" : ", ") + std::string(preset.name);
  }
  throw Error(ErrorKind::bad_config, "there is no " + kind + " " + name_or_file + "; known are " +
                                         known + ", or give a file NAME.yaml");
}

}  // namespace skycap::missions::file
