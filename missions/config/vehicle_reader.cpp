#include "missions/config/vehicle_reader.h"

#include <array>
#include <optional>
#include <span>

#include "flight/motion/motion.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/config/preset_files.h"
#include "missions/config/sensor_reader.h"
#include "missions/support/yaml_section.h"

namespace skycap::missions::config {
namespace {

using flight::MissionMode;
using flight::Vehicle;

using geometry::radians_per_degree;

/// Numeric key of a description with its range in the file's unit and the factor to internal units.
template <typename Owner>
struct NumberKey {
  const char* key;
  double Owner::*field;
  double min, max;
  double unit = 1.0;
};

constexpr std::array vehicle_numbers{
    NumberKey<Vehicle>{"radius", &Vehicle::radius, 0.01, 20},
    NumberKey<Vehicle>{"max_speed", &Vehicle::max_speed, 0.1, 100},
    NumberKey<Vehicle>{"max_wind", &Vehicle::max_wind, 0, 50},
    NumberKey<Vehicle>{"gimbal_rate_deg", &Vehicle::gimbal_rate, 1, 1000, radians_per_degree},
    NumberKey<Vehicle>{"gimbal_min_deg", &Vehicle::gimbal_min, -180, 90, radians_per_degree},
    NumberKey<Vehicle>{"gimbal_max_deg", &Vehicle::gimbal_max, -90, 180, radians_per_degree},
    NumberKey<Vehicle>{"sway_speed", &Vehicle::sway_speed, 0, 10},
    NumberKey<Vehicle>{"sway_rate_deg", &Vehicle::sway_rate, 0, 100, radians_per_degree},
    NumberKey<Vehicle>{"mass", &Vehicle::mass, 0.01, 1000},
    NumberKey<Vehicle>{"rotor_diameter", &Vehicle::rotor_diameter, 0.01, 10},
    NumberKey<Vehicle>{"battery_wh", &Vehicle::battery_wh, 0.1, 1e5},
    NumberKey<Vehicle>{"endurance_min", &Vehicle::endurance_min, 0.1, 1e4},
    NumberKey<Vehicle>{"avionics_power", &Vehicle::avionics_power, 0, 1e4},
    NumberKey<Vehicle>{"drag_area", &Vehicle::drag_area, 0, 10},
    NumberKey<Vehicle>{"energy_error", &Vehicle::energy_error, 0, 0.9},
};

constexpr NumberKey<Vehicle> position_error{"position_error", &Vehicle::position_error, 0, 100};

constexpr std::array mode_numbers{
    NumberKey<MissionMode>{"max_ascent", &MissionMode::max_ascent, 0.1, 50},
    NumberKey<MissionMode>{"max_descent", &MissionMode::max_descent, 0.1, 50},
    NumberKey<MissionMode>{"acceleration", &MissionMode::acceleration, 0.1, 50},
    NumberKey<MissionMode>{"vertical_acceleration", &MissionMode::vertical_acceleration, 0.1, 50},
    NumberKey<MissionMode>{"jerk", &MissionMode::jerk, 0.1, 500},
    NumberKey<MissionMode>{"jerk_rise", &MissionMode::jerk_rise, 0, 5},
    NumberKey<MissionMode>{"settle_time", &MissionMode::settle_time, 0, 60},
    NumberKey<MissionMode>{"yaw_rate_deg", &MissionMode::yaw_rate, 1, 1000, radians_per_degree},
    NumberKey<MissionMode>{"yaw_acceleration_deg", &MissionMode::yaw_acceleration, 1, 1e4,
                           radians_per_degree},
    NumberKey<MissionMode>{"takeoff_speed", &MissionMode::takeoff_speed, 0.1, 50},
    NumberKey<MissionMode>{"takeoff_ramp", &MissionMode::takeoff_ramp, 0, 60},
    NumberKey<MissionMode>{"landing_speed", &MissionMode::landing_speed, 0.05, 20},
    NumberKey<MissionMode>{"landing_height", &MissionMode::landing_height, 0, 1000},
    NumberKey<MissionMode>{"touchdown_time", &MissionMode::touchdown_time, 0, 60},
};

/// Reads the keys of a description. If `keeps` is set, missing keys keep their values; otherwise
/// they are errors.
class VehicleReader {
 public:
  VehicleReader(support::YamlSection& root, Vehicle& vehicle, std::string& camera, bool keeps)
      : root_(root), vehicle_(vehicle), camera_(camera), keeps_(keeps) {}

  void read() {
    using flight::AutopilotType;
    vehicle_.name = root_.text("name");
    if (wants(root_, "dialect")) {
      vehicle_.autopilot =
          root_.choice<AutopilotType>("dialect", {{"px4", AutopilotType::px4},
                                                  {"ardupilot", AutopilotType::ardupilot},
                                                  {"dji", AutopilotType::dji}});
    }
    if (root_.has("app")) {
      using flight::MissionApp;
      if (vehicle_.autopilot != AutopilotType::dji) {
        root_.fail_at("app", "requires dialect: dji");
      }
      vehicle_.app = root_.choice<MissionApp>(
          "app",
          {{"pilot", MissionApp::pilot}, {"fly", MissionApp::fly}, {"litchi", MissionApp::litchi}});
    }
    if (vehicle_.autopilot == AutopilotType::dji || root_.has("wpml")) read_codes();
    read_numbers<Vehicle>(root_, vehicle_, vehicle_numbers);
    if (root_.has(position_error.key)) {  // optional, because descriptions of version 0.1 lack it
      read_numbers<Vehicle>(root_, vehicle_, std::span(&position_error, 1));
    }
    if (root_.has("camera")) camera_ = root_.text("camera");
    if (wants(root_, "rotors")) vehicle_.rotors = whole_number("rotors", 1, 100);
    if (wants(root_, "max_waypoints")) {
      vehicle_.max_waypoints = whole_number("max_waypoints", 20, 65535);
    }
    read_mode();
  }

 private:
  bool wants(support::YamlSection& section, const std::string& key) const {
    return !keeps_ || section.has(key);
  }

  std::optional<support::YamlSection> part(const std::string& key) {
    std::optional<support::YamlSection> section = root_.section(key);
    if (!section && !keeps_) root_.fail_at(key, "is missing");
    return section;
  }

  template <typename Owner>
  void read_numbers(support::YamlSection& section, Owner& owner,
                    std::span<const NumberKey<Owner>> keys) {
    for (const NumberKey<Owner>& number : keys) {
      if (!wants(section, number.key)) continue;
      const double value = section.number(number.key);
      section.require_between(number.key, value, number.min, number.max);
      owner.*number.field = number.unit * value;
    }
  }

  int whole_number(const std::string& key, int min, int max) {
    root_.require_between(key, root_.number(key), min, max);
    return root_.integer(key, min);
  }

  void read_mode() {
    std::optional<support::YamlSection> section = part("mode");
    if (!section) return;
    MissionMode& mode = vehicle_.mode;
    if (wants(*section, "law")) {
      mode.leg_profile = section->choice<flight::LegProfile>(
          "law", {{"s_curve", flight::LegProfile::s_curve},
                  {"braking_distance", flight::LegProfile::braking_distance}});
    }
    read_numbers<MissionMode>(*section, mode, mode_numbers);
    section->finish();
  }

  void read_codes() {
    std::optional<support::YamlSection> section = part("wpml");
    if (!section) {
      if (vehicle_.wpml.drone <= 0)
        root_.fail_at("wpml", "is missing; DJI vehicles require their product codes");
      return;
    }
    flight::WpmlCodes& codes = vehicle_.wpml;
    if (wants(*section, "version")) codes.version = section->text("version");
    codes.drone = section->integer("drone", codes.drone);
    codes.drone_variant = section->integer("drone_variant", codes.drone_variant);
    codes.payload = section->integer("payload", codes.payload);
    section->finish();
    if (codes.drone <= 0) root_.fail_at("wpml", "must contain the DJI product number of the drone");
  }

  support::YamlSection& root_;
  Vehicle& vehicle_;
  std::string& camera_;
  bool keeps_;
};

/// A vehicle and the preset of its own camera.
struct Profile {
  flight::Vehicle vehicle;
  std::string camera;
};

Profile read_profile(const std::string& text, const std::string& file);

Profile find_profile(const std::string& name_or_file) {
  const PresetText found = preset_text("vehicle", name_or_file, vehicle_preset_files());
  return read_profile(found.text, found.file);
}

Profile read_profile(const std::string& text, const std::string& file) {
  const support::YamlNode tree = support::parse_yaml(text, file);
  support::YamlSection root(tree, "", file);
  Profile profile;
  Vehicle& vehicle = profile.vehicle;
  const bool has_base_vehicle = root.has("like");
  if (has_base_vehicle) {
    const std::string preset = root.text("like");
    if (preset.ends_with(".yaml")) root.fail_at("like", "must be the name of a preset");
    try {
      profile = find_profile(preset);
    } catch (const Error& error) {
      root.fail_at("like", error.what());
    }
  }
  VehicleReader(root, vehicle, profile.camera, has_base_vehicle).read();
  root.finish();
  if (vehicle.gimbal_min > vehicle.gimbal_max) {
    root.fail_at("gimbal_max_deg",
                 "must be at least gimbal_min_deg; equal values describe a fixed camera");
  }
  if (!profile.camera.empty()) {
    try {
      find_camera(profile.camera);
    } catch (const Error& error) {
      root.fail_at("camera", error.what());
    }
  }
  try {
    const flight::Motion motion(vehicle, {.cruise_speed = vehicle.max_speed});
  } catch (const Error& error) {  // conflicting values
    root.fail_at("endurance_min", error.what());
  }
  return profile;
}

}  // namespace

flight::Vehicle read_vehicle(const std::string& text, const std::string& file) {
  return read_profile(text, file).vehicle;
}

std::vector<std::string_view> vehicle_presets() {
  std::vector<std::string_view> names;
  for (const PresetFile& preset : vehicle_preset_files()) names.push_back(preset.name);
  return names;
}

flight::Vehicle find_vehicle(const std::string& name_or_file) {
  return find_profile(name_or_file).vehicle;
}

std::string find_vehicle_camera(const std::string& name_or_file) {
  return find_profile(name_or_file).camera;
}

}  // namespace skycap::missions::config
