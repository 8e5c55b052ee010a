/// Vehicle descriptions: YAML files that say what a vehicle can do and how its autopilot flies it,
/// and the presets that come with the program (flight/motion/presets/*.yaml, compiled into it).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "flight/motion/vehicle.h"

namespace skycap::missions::config {

/// Reads the text of a description; `file` is what messages call it. A description with the key
/// `like` starts from that preset and says what is different; any other says everything. Throws
/// Error{bad_config} in the form "FILE:LINE: key KEY WHAT IS WRONG", for unknown, missing and
/// mistyped keys and values out of range.
flight::Vehicle read_vehicle(const std::string& text, const std::string& file);

/// The names of the presets, such as "m350_rtk", in alphabetical order.
std::vector<std::string_view> vehicle_presets();

/// The vehicle of that name, or that the file of that path holds if it ends in .yaml. Throws
/// Error{bad_config} with the known names, or Error{bad_file}.
flight::Vehicle find_vehicle(const std::string& name_or_file);

}  // namespace skycap::missions::config
