/// A first mission file for a site: it runs as it is, and says of each value what it is for.
#pragma once

#include <filesystem>
#include <string>

#include "missions/site/wishes.h"

namespace skycap::missions::site {

/// The text of a mission that is to be written to `file`: the target, the prior data, where the
/// pad, the fence and the space that nobody knows are proposed to be, a sensor, and how closely it
/// is looked at. Its scene is the target, for a dry run. Throws Error{bad_config} if the target is
/// not found, if the files do not say where they are, or if there is no room for a pad within 100 m
/// of the target; what derived::parse_mission() throws.
std::string propose_mission(const Wishes& wishes, const std::filesystem::path& file);

}  // namespace skycap::missions::site
