#include "missions/package/inspection_summary.h"

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/io/output_folder.h"
#include "geometry/pose/world.h"
#include "missions/package/package.h"
#include "missions/package/settings.h"
#include "missions/support/json_text.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;

/// Removes the limits that complete_inspection() derives from the vehicle.
void remove_limits(Json& settings) {
  if (!settings.is_object()) return;
  for (const char* limit :
       {"speed", "acceleration", "jerk", "yaw_rate_deg", "yaw_acceleration_deg"}) {
    settings.erase(std::string("inspection.max_") + limit);
  }
}

}  // namespace

std::optional<InspectionSummary> read_inspection_summary(
    const std::filesystem::path& folder, const std::vector<config::KeyOverride>& overrides) {
  const std::filesystem::path file = folder / summary_name;
  const std::string name = file.string();
  geometry::finish_commit(folder);
  try {
    const Json json = geometry::parse_json<Json>(geometry::read_file(file, geometry::largest_json));
    if (!json.is_object() || json.value("kind", Json()) != "inspection") return std::nullopt;
    Json settings = json.at("settings");
    if (std::ranges::find(overrides, "flight.vehicle", &config::KeyOverride::path) !=
        overrides.end()) {
      remove_limits(settings);
    }
    InspectionSummary summary{mission_from_settings(settings, name, overrides), std::nullopt};
    summary.attainable = json.at("inspection").at("attainable_points").get<std::size_t>();
    if (json.contains("flight")) {
      summary.pad =
          summary.mission.flight().takeoff.value_or(support::to_vector(json["flight"].at("pad")));
      geometry::require_valid_position(*summary.pad, name + ": flight.pad");
    }
    return summary;
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::bad_file,
                name + ": is not the summary of an inspection (" + error.what() + ")");
  }
}

}  // namespace skycap::missions::package
