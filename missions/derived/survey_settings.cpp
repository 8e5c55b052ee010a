#include "missions/derived/survey_settings.h"

#include <utility>

#include <fmt/format.h>

#include "geometry/io/file.h"
#include "geometry/io/record_log.h"
#include "missions/derived/mission_priors.h"
#include "missions/file/mission_keys.h"

namespace skycap::missions::derived {

namespace {

/// The sources without the folders of their files.
std::vector<prior::Source> wherever_they_lie(std::vector<prior::Source> sources) {
  for (prior::Source& source : sources) {
    source.file = source.file.filename();
    source.select.within = source.select.within.filename();
  }
  return sources;
}

}  // namespace

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
    if (key.path == "prior") text = file::to_text(wherever_they_lie(mission.prior));
    settings.push_back({key.path, std::move(text)});
  }
  // Of prior data what it holds, too.
  std::size_t number = 0;
  for (const std::string& digest : priors_of(mission).digests) {
    settings.push_back({"prior[" + std::to_string(number++) + "]", digest});
  }
  return settings;
}

}  // namespace skycap::missions::derived
