/// Returns the ground of pads and rally points for summary.json.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/route/landing_surface.h"

namespace skycap::missions::package {

nlohmann::ordered_json landing_surfaces_json(
    std::span<const flight::LandingSurface> landing_surfaces);

/// Reads the measured grounds from summary.json. Other grounds follow from the mission. Throws
/// exceptions of nlohmann::json, and Error{bad_file} for invalid values. `name` is the file name in
/// messages.
std::vector<flight::LandingSurface> measured_landing_surfaces(const nlohmann::ordered_json& list,
                                                              const std::string& name);

/// Returns one line with the known slopes of the landing points, or an empty string if none is
/// known.
std::string landing_surfaces_text(std::span<const flight::LandingSurface> landing_surfaces);

}  // namespace skycap::missions::package
