/// Rules of photo cameras for other keys of a mission: values that follow from them, and
/// checks.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/pose/photo_camera.h"
#include "missions/config/mission_document.h"
#include "survey/photo/photo_planner.h"

namespace skycap::missions::config {

/// Options of the photos that a mission plans.
struct PhotoSetup {
  survey::photo::PhotoPlanOptions options;
  FreeSpaceRule free_space = FreeSpaceRule::measured;
  PhotoPass pass = PhotoPass::final_pass;
};

/// The key that replaces a key of depth sensing where there is a photo camera, "-" if none does;
/// empty for keys that apply to photo cameras as well.
std::string_view find_replacing_photo_key(std::string_view key);

/// Checks the keys of photos against the others. Throws Error{bad_config} as
/// MissionDocument::reject() if keys of depth sensing are given beside a photo camera, naming the
/// key that replaces them; if photos have no target or no ground sampling distance; or if keys of
/// photos are given without a photo camera.
void check_photo(const MissionDocument& document);

/// Puts a photo camera in the depth camera's place, with the view distance that the mission's
/// ground sampling distance requires. The document is checked.
void complete_photo(MissionDocument& document, const geometry::PhotoCameraConfig& camera);

/// The photos of a complete document with a photo camera.
PhotoSetup photo_setup(const MissionDocument& document);

}  // namespace skycap::missions::config
