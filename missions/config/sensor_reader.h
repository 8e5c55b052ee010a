/// Sensor descriptions: YAML files that say what a sensor measures and with what errors, and the
/// presets that come with the program (sim/sensors/presets/*.yaml, compiled into it).
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/sensors/depth_camera.h"
#include "sim/sensors/sensor.h"

namespace skycap::missions::config {

struct SensorDescription {
  std::string name;  ///< as the file calls it
  std::variant<sim::LidarConfig, sim::DepthCameraConfig> sensor;
  std::string text;  ///< of the file
};

/// Reads the text of a description; `file` is what messages call it. Throws Error{bad_config} in
/// the form "FILE:LINE: key KEY WHAT IS WRONG", for unknown, missing and mistyped keys too.
SensorDescription read_sensor(const std::string& text, const std::string& file);

/// The names of the presets, such as "ouster_os1_128", in alphabetical order.
std::vector<std::string_view> sensor_presets();

/// The description of that name, or that the file of that path holds if it ends in .yaml. Throws
/// Error{bad_config} with the known names, or Error{bad_file}.
SensorDescription find_sensor(const std::string& name_or_file);

}  // namespace skycap::missions::config
