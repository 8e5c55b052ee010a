// skycap presets: lists the built-in vehicles and sensors.
#include <memory>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/angle.h"
#include "missions/cli/command_options.h"
#include "missions/config/photo_camera_reader.h"
#include "missions/config/sensor_reader.h"
#include "missions/config/vehicle_reader.h"

namespace skycap::missions::cli {
namespace {

using Json = nlohmann::ordered_json;

struct PresetsOptions {
  bool is_json = false;
};

double degrees(double radians) { return radians / geometry::radians_per_degree; }

const char* autopilot_name(const flight::Vehicle& vehicle) {
  switch (vehicle.autopilot) {
    case flight::AutopilotType::px4:
      return "PX4";
    case flight::AutopilotType::ardupilot:
      return "ArduPilot";
    case flight::AutopilotType::dji:
      break;
  }
  return "DJI";
}

Json to_json(const flight::Vehicle& vehicle) {
  return {{"name", vehicle.name},
          {"autopilot", autopilot_name(vehicle)},
          {"mass_kg", vehicle.mass},
          {"radius_m", vehicle.radius},
          {"max_speed_m_s", vehicle.max_speed},
          {"max_wind_m_s", vehicle.max_wind},
          {"position_error_m", vehicle.position_error},
          {"battery_wh", vehicle.battery_wh},
          {"endurance_min", vehicle.endurance_min}};
}

/// Returns the horizontal and vertical field of view of a scanner, as far as it follows from
/// channels and rotation.
Json to_json(const sim::LidarConfig& scanner) {
  Json json{{"kind", scanner.prisms.empty() ? "spinning LiDAR" : "rosette LiDAR"},
            {"min_range_m", scanner.min_range},
            {"max_range_m", scanner.max_range},
            {"channels", scanner.channels.size()},
            {"pulses_per_s", static_cast<double>(scanner.channels.size()) / scanner.firing_period}};
  if (scanner.prisms.empty()) json["horizontal_fov_deg"] = degrees(scanner.field_of_view);
  return json;
}

Json to_json(const sim::DepthCameraConfig& camera) {
  return {{"kind", "depth camera"},
          {"min_range_m", camera.camera.min_range},
          {"max_range_m", camera.camera.max_range},
          {"width_px", camera.camera.width},
          {"height_px", camera.camera.height},
          {"horizontal_fov_deg", degrees(camera.camera.horizontal_fov)},
          {"vertical_fov_deg", degrees(camera.camera.vertical_fov)}};
}

Json to_json(const geometry::PhotoCamera& camera) {
  const geometry::PhotoCameraConfig& config = camera.config();
  constexpr double millimetres = 1e3, distance = 10.0;
  return {
      {"sensor_mm", {millimetres * config.sensor_size.x(), millimetres * config.sensor_size.y()}},
      {"width_px", config.width},
      {"height_px", config.height},
      {"focal_length_mm", millimetres * config.focal_length},
      {"gsd_at_10_m_mm", millimetres * camera.gsd(distance)},
      {"min_interval_s", config.min_interval},
      {"shutter",
       config.shutter == geometry::ShutterKind::mechanical ? "mechanical" : "electronic"}};
}

Json all_presets() {
  Json vehicles = Json::array(), sensors = Json::array(), photo_cameras = Json::array();
  for (const std::string_view name : config::photo_camera_presets()) {
    const geometry::PhotoCamera camera(config::find_photo_camera(std::string(name)));
    Json json{{"name", name}, {"title", camera.config().name}};
    json.update(to_json(camera));
    photo_cameras.push_back(std::move(json));
  }
  for (const std::string_view name : config::vehicle_presets()) {
    Json vehicle = to_json(config::find_vehicle(std::string(name)));
    vehicle["name"] = name;
    vehicles.push_back(std::move(vehicle));
  }
  for (const std::string_view name : config::sensor_presets()) {
    const config::SensorDescription found = config::find_sensor(std::string(name));
    Json sensor{{"name", name}, {"title", found.name}};
    sensor.update(std::visit([](const auto& config) { return to_json(config); }, found.sensor));
    if (found.useful_range) {
      sensor["useful_range_m"] = {found.useful_range->min, found.useful_range->max};
    }
    sensors.push_back(std::move(sensor));
  }
  return {{"vehicles", vehicles}, {"sensors", sensors}, {"photo_cameras", photo_cameras}};
}

std::string vehicle_line(const Json& vehicle) {
  return fmt::format(
      "  {:<20} {:<10} {:>6.3g} kg  {:>5.3g} m  {:>5.3g} m/s  {:>5.3g} m/s  "
      "{:>6.4g} Wh  {:>4.3g} min\n",
      vehicle["name"].get<std::string>(), vehicle["autopilot"].get<std::string>(),
      vehicle["mass_kg"].get<double>(), vehicle["radius_m"].get<double>(),
      vehicle["max_speed_m_s"].get<double>(), vehicle["max_wind_m_s"].get<double>(),
      vehicle["battery_wh"].get<double>(), vehicle["endurance_min"].get<double>());
}

/// Returns a range of depths. Cameras without a limit have the maximum range of CameraConfig.
std::string depth_range_text(double min, double max) {
  if (max >= geometry::CameraConfig{}.max_range) return "no limit";
  return fmt::format("{:.3g} to {:.4g} m", min, max);
}

std::string sensor_line(const Json& sensor) {
  const std::string useful = sensor.contains("useful_range_m")
                                 ? depth_range_text(sensor["useful_range_m"][0].get<double>(),
                                                    sensor["useful_range_m"][1].get<double>())
                                 : "";
  const std::string resolution =
      sensor.contains("width_px")
          ? fmt::format("{} x {} px, {:.3g} x {:.3g} degrees", sensor["width_px"].get<int>(),
                        sensor["height_px"].get<int>(), sensor["horizontal_fov_deg"].get<double>(),
                        sensor["vertical_fov_deg"].get<double>())
          : fmt::format("{} channels, {:.4g} pulses/s", sensor["channels"].get<std::size_t>(),
                        sensor["pulses_per_s"].get<double>());
  return fmt::format(
      "  {:<20} {:<14} {:<13}  {:<10}  {}\n", sensor["name"].get<std::string>(),
      sensor["kind"].get<std::string>(),
      depth_range_text(sensor["min_range_m"].get<double>(), sensor["max_range_m"].get<double>()),
      useful, resolution);
}

std::string photo_camera_line(const Json& camera) {
  const auto number = [&](const char* key) { return camera[key].get<double>(); };
  return fmt::format(
      "  {:<20} {:>12} mm  {:>12} px  {:>5.2f} mm  {:>5.2f} mm  {:>5.3g} s  {}\n",
      camera["name"].get<std::string>(),
      fmt::format("{:g} x {:g}", camera["sensor_mm"][0].get<double>(),
                  camera["sensor_mm"][1].get<double>()),
      fmt::format("{} x {}", camera["width_px"].get<int>(), camera["height_px"].get<int>()),
      number("focal_length_mm"), number("gsd_at_10_m_mm"), number("min_interval_s"),
      camera["shutter"].get<std::string>());
}

int presets(const PresetsOptions& options, const Console& console) {
  const Json all = all_presets();
  if (options.is_json) {
    console.out << all.dump(2) << "\n" << std::flush;
    return 0;
  }
  std::string text = fmt::format(
      "Vehicles (flight.vehicle)\n  {:<20} {:<10} {:>9}  {:>7}  {:>9}  "
      "{:>9}  {:>9}  {:>8}\n",
      "name", "autopilot", "mass", "radius", "max speed", "max wind", "battery", "endurance");
  for (const Json& vehicle : all["vehicles"]) text += vehicle_line(vehicle);
  text += fmt::format(
      "Sensors (scan.sensor; LiDARs also sensor.lidar)\n  {:<20} {:<14} {:<13}  {:<10}  {}\n",
      "name", "kind", "range", "useful", "resolution");
  for (const Json& sensor : all["sensors"]) text += sensor_line(sensor);
  text += fmt::format(
      "Photo cameras (sensor.photo_camera)\n  {:<20} {:>15}  {:>15}  {:>8}  {:>8}  {:>7}  {}\n",
      "name", "sensor", "image", "focal", "at 10 m", "interval", "shutter");
  for (const Json& camera : all["photo_cameras"]) text += photo_camera_line(camera);
  text += "\"useful\": depths at which the camera is accurate, as stated by the manufacturer\n";
  text += "\"at 10 m\" is the ground sampling distance at a distance of 10 m\n";
  console.out << text << std::flush;
  return 0;
}

}  // namespace

void add_presets(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("presets", "List vehicle and sensor presets with their main properties");
  const auto options = std::make_shared<PresetsOptions>();
  command->add_flag("--json", options->is_json, "Print the list as JSON");
  run(*command, options, presets, console, action);
}

}  // namespace skycap::missions::cli
