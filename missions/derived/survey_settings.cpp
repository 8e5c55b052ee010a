#include "missions/derived/survey_settings.h"

#include "missions/file/mission_keys.h"

namespace skycap::missions::derived {

std::vector<Setting> survey_settings(const file::Mission& mission) {
  std::vector<Setting> settings;
  for (const file::Key& key : file::mission_keys()) {
    if (key.path == "name" || key.path == "seed" || key.path == "threads" ||
        key.path.starts_with("paper.")) {
      continue;
    }
    const auto value = key.get(mission);
    settings.push_back({key.path, value ? file::to_text(*value) : "-"});
  }
  return settings;
}

}  // namespace skycap::missions::derived
