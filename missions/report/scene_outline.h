/// What stands in the way of a flight and of a survey, for the 3-D view.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::report {

/// {"ground": z, "pad": [x, y, z] or null, "volumes": [{"role", "name", "corners", "bottom",
/// "top"}], "sensor": {"horizontal_fov", "vertical_fov", "view_distance", "lidar"}}, in metres and
/// radians. Roles: no_fly, geofence, unknown (what must be measured before it counts as free) and
/// scene (what is to be surveyed). A bottom or top of null has no end.
nlohmann::ordered_json scene_outline(const session::SurveyOptions& survey,
                                     const scene::SceneOptions& scene,
                                     const std::optional<Eigen::Vector3d>& pad);

}  // namespace skycap::missions::report
