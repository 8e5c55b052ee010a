/// Reads sensor descriptions: presets and user files.
#pragma once

#include <string>
#include <vector>

#include "sim/sensors/depth_camera_config.h"
#include "sim/sensors/sensor.h"

namespace skycap::missions::api {

/// Returns the names of the presets in alphabetical order.
std::vector<std::string> sensor_names();

/// Returns the depth camera of a preset or .yaml file. Throws Error{bad_config} if the name is
/// unknown or denotes a laser scanner. Throws Error{bad_file} if the file cannot be read.
sim::DepthCameraConfig depth_camera(const std::string& name_or_file);

/// Returns the laser scanner of a preset or .yaml file. Throws Error{bad_config} if the name is
/// unknown or denotes a camera. Throws Error{bad_file} if the file cannot be read.
sim::LidarConfig laser_scanner(const std::string& name_or_file);

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< public name for user programs
}
