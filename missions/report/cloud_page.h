/// Pages of what is no survey: a cloud of whatever origin, and a mission before anything was seen.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::report {

/// The points of a file. Throws what geometry::read_cloud() throws.
std::string cloud_page(const std::filesystem::path& cloud);

/// A mission's scene with all that a flight must keep away from; `surface` are points of the model.
std::string mission_page(const std::string& name, const session::SurveyOptions& survey,
                         const scene::SceneOptions& scene, std::span<const Eigen::Vector3f> surface,
                         const std::optional<Eigen::Vector3d>& pad);

}  // namespace skycap::missions::report
