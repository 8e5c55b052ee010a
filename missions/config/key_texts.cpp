#include "missions/config/key_texts.h"

#include <utility>

#include <fmt/format.h>

#include "missions/config/mission_keys.h"
#include "missions/config/photo_rules.h"
#include "missions/site_data/site_priors.h"

namespace skycap::missions::config {
namespace {

/// Returns the sources with file names instead of paths.
std::vector<site_data::Source> without_folders(std::vector<site_data::Source> sources) {
  for (site_data::Source& source : sources) {
    source.file = source.file.filename();
    source.select.within = source.select.within.filename();
  }
  return sources;
}

bool decides_what_is_attainable(std::string_view path) {
  return path.starts_with("scene.") || path.starts_with("sensor.") ||
         path.starts_with("evaluation.") || path.starts_with("planner.scene_box") ||
         path.starts_with("site.") || path == "start.position" ||
         path == "limits.ground_clearance" || path == "limits.stand_off" ||
         path.ends_with("_pitch_deg") || path == "flight.vehicle" || path == "flight.clearance";
}

}  // namespace

bool applies(const Key& key, const MissionDocument& document) {
  if (key.path.starts_with("inspection.")) return document.is_inspection();
  if (key.path == "flight.free_space") return document.is_for_known_target();
  if (document.is_inspection() && key.path.starts_with("photo.")) return false;
  const bool is_of_photos = key.path.starts_with("photo.") || key.path == "sensor.photo_camera";
  if (!document.is_photo()) return !is_of_photos;
  return is_of_photos || find_replacing_photo_key(key.path).empty();
}

std::vector<support::Setting> survey_settings(
    const MissionDocument& document, const std::optional<std::uint32_t>& vehicle_checksum) {
  std::vector<support::Setting> settings;
  for (const Key& key : mission_keys()) {
    if (key.path == "name" || key.path == "seed" || key.path == "threads" ||
        key.path.starts_with("paper.") || !applies(key, document)) {
      continue;
    }
    const auto value = key.get(document);
    std::string text = value ? to_text(*value) : "-";
    // Vehicle files are identified by their content, not by their path.
    if (key.path == "flight.vehicle" && vehicle_checksum) {
      text = fmt::format("description {:08x}", *vehicle_checksum);
    }
    if (key.path == "prior") text = to_text(without_folders(document.prior));
    settings.push_back({key.path, std::move(text)});
  }
  // Prior data is identified by its content as well.
  if (!document.scene.priors) return settings;
  std::size_t number = 0;
  for (const std::string& file_checksum : document.scene.priors->checksums) {
    settings.push_back({"prior[" + std::to_string(number++) + "]", file_checksum});
  }
  return settings;
}

std::string attainable_inputs(const MissionDocument& document) {
  std::string inputs;
  for (const Key& key : mission_keys()) {
    if (!decides_what_is_attainable(key.path) || !applies(key, document)) continue;
    const auto value = key.get(document);
    inputs += "\n" + key.path + " " + (value ? to_text(*value) : "-");
  }
  // Terrain hides surface and limits view heights, as part of the prior data.
  if (!document.scene.priors) return inputs;
  for (const std::string& file_checksum : document.scene.priors->checksums)
    inputs += "\n" + file_checksum;
  return inputs;
}

}  // namespace skycap::missions::config
