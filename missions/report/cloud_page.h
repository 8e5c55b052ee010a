/// HTML reports of a single cloud and of a mission before its survey.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::report {

/// Returns the HTML report of a cloud file. Throws the errors of geometry::read_cloud().
std::string cloud_page(const std::filesystem::path& cloud);

/// Returns the HTML report of points with a colour each. `facts` are shown above the view.
std::string coloured_points_page(const std::string& title, const std::vector<std::string>& facts,
                                 std::span<const Eigen::Vector3f> points,
                                 const std::vector<std::array<std::uint8_t, 3>>& colours);

/// Returns points on the targets of the prior data, for missions without a simulated scene.
std::vector<Eigen::Vector3f> target_points(const scene::SceneOptions& scene);

/// Returns the HTML report of a mission's scene with its airspace limits. `surface` contains points
/// of the model.
std::string mission_page(const std::string& name, const session::SurveyOptions& survey,
                         const scene::SceneOptions& scene, std::span<const Eigen::Vector3f> surface,
                         const std::optional<Eigen::Vector3d>& pad);

}  // namespace skycap::missions::report
