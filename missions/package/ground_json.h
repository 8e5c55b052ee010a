/// The ground of pads and rally points, as summary.json holds it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/route/pad_ground.h"

namespace skycap::missions::package {

nlohmann::ordered_json grounds_json(std::span<const flight::PadGround> grounds);

/// Those that were measured; the others follow from the mission. Throws what nlohmann::json throws,
/// and Error{bad_file} on values that no ground has; `name` stands for the file.
std::vector<flight::PadGround> measured_grounds(const nlohmann::ordered_json& list,
                                                const std::string& name);

/// A line for the user: slopes of the landing points that are known; empty if none is.
std::string grounds_text(std::span<const flight::PadGround> grounds);

}  // namespace skycap::missions::package
