/// Descriptions of sensors: those that come with Skycap, and files of one's own.
#pragma once

#include <string>
#include <vector>

#include "sim/sensors/depth_camera_config.h"
#include "sim/sensors/sensor.h"

namespace skycap::missions::api {

/// The names of the descriptions that come with Skycap, in alphabetical order.
std::vector<std::string> sensor_names();

/// The depth camera of that name, or that the .yaml file of that path describes. Throws
/// Error{bad_config} with the known names, or if it is a laser scanner, and Error{bad_file}.
sim::DepthCameraConfig depth_camera(const std::string& name_or_file);

/// The same of a laser scanner.
sim::LidarConfig laser_scanner(const std::string& name_or_file);

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< the name in programs of users
}
