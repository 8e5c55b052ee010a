/// The photo camera of a mission as far as the flight depends on it.
#pragma once

#include <optional>
#include <string_view>

#include "flight/motion/photo_speed.h"
#include "geometry/pose/photo_camera.h"

namespace skycap::missions::config {

/// payloadEnumValue of DJI's WPML for a camera by the name of its preset, such as
/// "zenmuse_p1_35"; nothing for cameras of other makers. Source: DJI Cloud API documentation,
/// "Product Support" and "Common Elements".
std::optional<int> wpml_payload(std::string_view camera);

/// The camera as far as the flight depends on it, for photos with that ground sampling distance
/// [m].
flight::PhotoShutter make_photo_shutter(const geometry::PhotoCameraConfig& camera, double gsd);

}  // namespace skycap::missions::config
