/// Reads sensor descriptions: YAML files that specify measurement characteristics and errors. The
/// presets in sim/sensors/presets/*.yaml are compiled into the program.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/sensors/depth_camera.h"
#include "sim/sensors/sensor.h"

namespace skycap::missions::config {

/// Depths between which a sensor measures well enough to be planned with [m].
struct RangeInterval {
  double min = 0.0, max = 0.0;
};

struct SensorDescription {
  std::string name;  ///< sensor name in the description
  std::variant<sim::LidarConfig, sim::DepthCameraConfig> sensor;
  std::optional<RangeInterval> useful_range;  ///< of a camera that states one
  std::string text;                           ///< contents of the description file
  int wpml_payload = 0;                       ///< DJI payload number of a scanner, or 0.
};

/// Parses a sensor description. `file` is the file name in messages. Throws Error{bad_config} with
/// "FILE:LINE: key KEY WHAT IS WRONG" for unknown, missing and invalid keys.
SensorDescription read_sensor(const std::string& text, const std::string& file);

/// Returns the names of the presets in alphabetical order, such as "ouster_os1_128".
std::vector<std::string_view> sensor_presets();

/// The description of that name, or that the file of that path holds if it ends in .yaml. "d435"
/// and "high_resolution" name the cameras of the SEE++ experiments. Throws Error{bad_config} with
/// the known names, or Error{bad_file}.
SensorDescription find_sensor(const std::string& name_or_file);

/// The camera preset of that name. Throws Error{bad_config} that names `sensor.lidar` if it is a
/// LiDAR, lists the camera presets if it is unknown, and rejects paths of files.
SensorDescription find_camera(const std::string& name);

}  // namespace skycap::missions::config
