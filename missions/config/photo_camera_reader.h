/// Descriptions of photo cameras: YAML files with the values of data sheets, and built-in presets
/// (survey/photo/presets/*.yaml, compiled into the program).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "geometry/pose/photo_camera.h"

namespace skycap::missions::config {

/// Reads the text of a description. `file` is its name in messages. Throws Error{bad_config} in the
/// form "FILE:LINE: key KEY PROBLEM", or "FILE: " followed by the error of
/// PhotoCameraConfig::validate().
geometry::PhotoCameraConfig read_photo_camera(const std::string& text, const std::string& file);

/// Returns the names of the presets, such as "mavic_3e_wide", in alphabetical order.
std::vector<std::string_view> photo_camera_presets();

/// Returns the preset with that name or, if the name ends in .yaml, the description in that file.
/// Throws Error{bad_config} with the known names, or Error{bad_file}.
geometry::PhotoCameraConfig find_photo_camera(const std::string& name_or_file);

}  // namespace skycap::missions::config
