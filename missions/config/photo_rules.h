/// Effects of a photo camera on other keys of a mission: derived values and checks.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/pose/photo_camera.h"
#include "missions/config/mission_document.h"
#include "survey/photo/photo_planner.h"

namespace skycap::missions::config {

/// Options for the photos of a mission.
struct PhotoSetup {
  survey::photo::PhotoPlanOptions options;
  FreeSpaceRule free_space = FreeSpaceRule::measured;
  PhotoPass pass = PhotoPass::final_pass;
};

/// Returns the key that replaces a key for depth sensors if the mission has a photo camera, or "-"
/// without a replacement. Returns an empty string for keys that also apply to photo cameras.
std::string_view find_replacing_photo_key(std::string_view key);

/// Checks the keys of `photo` against the others. Throws the error of MissionDocument::reject() if
/// keys for depth sensors are combined with a photo camera; the message contains the replacement.
/// Also throws it if photos have no target or no ground sampling distance, or if `photo` is used
/// without a photo camera.
void check_photo(const MissionDocument& document);

/// Replaces the depth camera by a photo camera, with the view distance required by the mission's
/// ground sampling distance. The document must have passed check_photo().
void complete_photo(MissionDocument& document, const geometry::PhotoCameraConfig& camera);

/// Returns the photo options of a complete document with a photo camera.
PhotoSetup photo_setup(const MissionDocument& document);

}  // namespace skycap::missions::config
