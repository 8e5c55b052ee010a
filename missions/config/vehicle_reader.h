/// Reads vehicle descriptions: YAML files that specify flight performance and autopilot behaviour.
/// The presets in flight/motion/presets/*.yaml are compiled into the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "flight/motion/vehicle.h"

namespace skycap::missions::config {

/// Parses a vehicle description. `file` is the file name in messages. With the key `base_vehicle`,
/// the named preset provides the values of missing keys; otherwise every key is required. Throws
/// Error{bad_config} with "FILE:LINE: key KEY WHAT IS WRONG" for unknown, missing, mistyped and
/// out-of-range keys.
flight::Vehicle read_vehicle(const std::string& text, const std::string& file);

/// Returns the names of the presets in alphabetical order, such as "m350_rtk".
std::vector<std::string_view> vehicle_presets();

/// Returns the preset with the given name, or reads a description if the name ends in .yaml. Throws
/// Error{bad_config} with a list of known names, or Error{bad_file} if the file cannot be read.
flight::Vehicle find_vehicle(const std::string& name_or_file);

/// Name of the preset of its own camera (find_camera()); empty if its description names none.
/// Throws what find_vehicle() throws.
std::string find_vehicle_camera(const std::string& name_or_file);

}  // namespace skycap::missions::config
