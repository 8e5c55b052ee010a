#include "missions/api/sensors.h"

#include <utility>
#include <variant>

#include "geometry/error.h"
#include "missions/config/sensor_reader.h"

namespace skycap::missions::api {
namespace {

template <typename Config>
Config sensor_as(const std::string& name_or_file, const char* what_it_is_not) {
  config::SensorDescription description = config::find_sensor(name_or_file);
  auto* config = std::get_if<Config>(&description.sensor);
  if (config == nullptr) {
    throw Error(ErrorKind::bad_config, description.name + what_it_is_not);
  }
  return std::move(*config);
}

}  // namespace

std::vector<std::string> sensor_names() {
  const std::vector<std::string_view> names = config::sensor_presets();
  return {names.begin(), names.end()};
}

sim::DepthCameraConfig depth_camera(const std::string& name_or_file) {
  return sensor_as<sim::DepthCameraConfig>(name_or_file,
                                           " is a laser scanner; a depth camera is required");
}

sim::LidarConfig laser_scanner(const std::string& name_or_file) {
  return sensor_as<sim::LidarConfig>(name_or_file,
                                     " is a camera; scanning in pieces requires a laser scanner");
}

}  // namespace skycap::missions::api
