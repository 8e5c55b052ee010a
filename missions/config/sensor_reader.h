/// Reads sensor descriptions: YAML files that specify measurement characteristics and errors. The
/// presets in sim/sensors/presets/*.yaml are compiled into the program.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/sensors/depth_camera.h"
#include "sim/sensors/sensor.h"

namespace skycap::missions::config {

struct SensorDescription {
  std::string name;  ///< sensor name in the description
  std::variant<sim::LidarConfig, sim::DepthCameraConfig> sensor;
  std::string text;  ///< contents of the description file
};

/// Parses a sensor description. `file` is the file name in messages. Throws Error{bad_config} with
/// "FILE:LINE: key KEY WHAT IS WRONG" for unknown, missing and invalid keys.
SensorDescription read_sensor(const std::string& text, const std::string& file);

/// Returns the names of the presets in alphabetical order, such as "ouster_os1_128".
std::vector<std::string_view> sensor_presets();

/// Returns the preset with the given name, or reads a description if the name ends in .yaml. Throws
/// Error{bad_config} with a list of known names, or Error{bad_file} if the file cannot be read.
SensorDescription find_sensor(const std::string& name_or_file);

}  // namespace skycap::missions::config
