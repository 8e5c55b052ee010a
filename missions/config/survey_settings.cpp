#include "missions/config/survey_settings.h"

#include <utility>

#include <fmt/format.h>

#include "geometry/io/file.h"
#include "geometry/io/record_log.h"
#include "missions/config/mission_keys.h"
#include "missions/config/mission_priors.h"

namespace skycap::missions::config {

namespace {

/// The sources without the folders of their files.
std::vector<site_data::Source> wherever_they_lie(std::vector<site_data::Source> sources) {
  for (site_data::Source& source : sources) {
    source.file = source.file.filename();
    source.select.within = source.select.within.filename();
  }
  return sources;
}

}  // namespace

std::vector<Setting> survey_settings(const config::Mission& mission) {
  constexpr std::size_t largest = 1 << 20;  // of a description, which was read before [byte]
  std::vector<Setting> settings;
  for (const config::Key& key : config::mission_keys()) {
    if (key.path == "name" || key.path == "seed" || key.path == "threads" ||
        key.path.starts_with("paper.")) {
      continue;
    }
    const auto value = key.get(mission);
    std::string text = value ? config::to_text(*value) : "-";
    // Of a description in a file what it says, wherever it lies.
    if (key.path == "flight.vehicle" && mission.flight.vehicle.ends_with(".yaml")) {
      text = fmt::format("description {:08x}",
                         geometry::crc32_of(geometry::read_file(mission.flight.vehicle, largest)));
    }
    if (key.path == "prior") text = config::to_text(wherever_they_lie(mission.prior));
    settings.push_back({key.path, std::move(text)});
  }
  // Of prior data what it holds, too.
  std::size_t number = 0;
  for (const std::string& digest : priors_of(mission).digests) {
    settings.push_back({"prior[" + std::to_string(number++) + "]", digest});
  }
  return settings;
}

}  // namespace skycap::missions::config
