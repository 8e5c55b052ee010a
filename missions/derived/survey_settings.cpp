#include "missions/derived/survey_settings.h"

#include <utility>

#include <fmt/format.h>

#include "geometry/io/file.h"
#include "geometry/io/record_log.h"
#include "missions/file/mission_keys.h"

namespace skycap::missions::derived {

std::vector<Setting> survey_settings(const file::Mission& mission) {
  constexpr std::size_t largest = 1 << 20;  // of a description, which was read before [byte]
  std::vector<Setting> settings;
  for (const file::Key& key : file::mission_keys()) {
    if (key.path == "name" || key.path == "seed" || key.path == "threads" ||
        key.path.starts_with("paper.")) {
      continue;
    }
    const auto value = key.get(mission);
    std::string text = value ? file::to_text(*value) : "-";
    // Of a description in a file what it says, wherever it lies.
    if (key.path == "flight.vehicle" && mission.flight.vehicle.ends_with(".yaml")) {
      text = fmt::format("description {:08x}",
                         geometry::crc32_of(geometry::read_file(mission.flight.vehicle, largest)));
    }
    settings.push_back({key.path, std::move(text)});
  }
  return settings;
}

}  // namespace skycap::missions::derived
