/// Descriptions of photo cameras: YAML files in the terms of data sheets, and the presets that come
/// with the program (survey/photo/presets/*.yaml, compiled into it).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "geometry/pose/photo_camera.h"

namespace skycap::missions::config {

/// Reads the text of a description; `file` is what messages call it. Throws Error{bad_config} in
/// the form "FILE:LINE: key KEY WHAT IS WRONG", or "FILE: " with what PhotoCameraConfig::validate()
/// throws.
geometry::PhotoCameraConfig read_photo_camera(const std::string& text, const std::string& file);

/// The names of the presets, such as "mavic_3e_wide", in alphabetical order.
std::vector<std::string_view> photo_camera_presets();

/// The description of that name, or that the file of that path holds if it ends in .yaml. Throws
/// Error{bad_config} with the known names, or Error{bad_file}.
geometry::PhotoCameraConfig find_photo_camera(const std::string& name_or_file);

}  // namespace skycap::missions::config
