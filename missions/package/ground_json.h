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

/// What the program prints: a line for each place to land of `expected`, known or not.
std::string grounds_text(std::span<const flight::PadGround> grounds, std::size_t expected);

}  // namespace skycap::missions::package
