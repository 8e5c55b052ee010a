/// Camera data of a photo mission that the flight depends on.
#pragma once

#include <optional>
#include <string_view>

#include "flight/motion/photo_speed.h"
#include "geometry/pose/photo_camera.h"

namespace skycap::missions::config {

/// Returns the payloadEnumValue of DJI's WPML for a camera preset such as "zenmuse_p1_35", or
/// nullopt for cameras of other makers. Source: DJI Cloud API documentation, "Product Support" and
/// "Common Elements".
std::optional<int> wpml_payload(std::string_view camera);

/// Returns the camera data that the flight depends on, for photos with ground sampling distance
/// `gsd` [m].
flight::PhotoShutter make_photo_shutter(const geometry::PhotoCameraConfig& camera, double gsd);

}  // namespace skycap::missions::config
