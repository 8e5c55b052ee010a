#include "missions/package/settings.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "missions/config/former_names.h"
#include "missions/config/key_texts.h"
#include "missions/config/mission_document.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "missions/config/setting_json.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;

/// Converts settings to the text of a mission file. JSON is valid YAML, but mission files nest
/// their keys.
std::string mission_text(const Json& settings) {
  Json nested = Json::object();
  for (const auto& [former, value] : settings.items()) {
    const std::string path = config::current_path(former);
    // A JSON pointer with a number would extend an array, but valid keys do not contain numbers.
    if (!config::find_key(path)) {
      throw Error(ErrorKind::bad_file, "settings." + former + " is unknown");
    }
    std::string pointer = "/" + path;
    std::ranges::replace(pointer, '.', '/');
    nested[Json::json_pointer(pointer)] = value;
  }
  return nested.dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

Json settings_json(const config::MissionSetup& setup) {
  config::MissionDocument document = *setup.document;
  document.seed = setup.run.seed;
  document.threads = setup.run.threads;
  Json values = Json::object();
  for (const config::Key& key : config::mission_keys()) {
    // A LiDAR replaces the camera, whose keys are then rejected.
    const bool is_flight_key = key.path == "sensor.capture" || key.path == "sensor.frame_period";
    const bool is_camera_key = key.path.starts_with("sensor.") && key.path != "sensor.lidar" &&
                               !(is_flight_key && setup.sensor().mount);
    if (is_camera_key && document.sensor.lidar) continue;
    if (!config::applies(key, document)) continue;
    if (const auto value = key.get(document)) values[key.path] = config::setting_json(*value);
  }
  return values;
}

config::MissionSetup mission_from_settings(const Json& settings, const std::string& name,
                                           const std::vector<config::KeyOverride>& overrides) {
  std::string text;
  try {
    text = mission_text(settings);
  } catch (const Error& error) {
    throw Error(error.kind(), name + ": " + error.what());
  }
  return config::parse_mission(text, name, overrides);
}

}  // namespace skycap::missions::package
