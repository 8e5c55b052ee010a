/// Obstacles, airspace and sensor data for the 3-D view.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::report {

/// Returns {"ground": z, "pad": [x, y, z] or null, "volumes": [{"role", "name", "corners",
/// "bottom", "top"}], "sensor": {"horizontal_fov", "vertical_fov", "view_distance", "lidar"}}.
/// Units are metres and radians. Roles: no_fly, geofence, unknown (unobserved space is occupied)
/// and scene (surveyed volume). A null bottom or top is unlimited.
nlohmann::ordered_json scene_outline(const session::SurveyOptions& survey,
                                     const scene::SceneOptions& scene,
                                     const std::optional<Eigen::Vector3d>& pad);

/// Returns the outline for the mission and the pad in the summary of the file `name`. Throws
/// nlohmann::json::exception if a value has the wrong type, and Error{bad_file} if the settings are
/// invalid.
nlohmann::ordered_json scene_outline(const nlohmann::ordered_json& summary,
                                     const std::string& name);

}  // namespace skycap::missions::report
