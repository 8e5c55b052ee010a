#include "flight/motion/vehicle.h"

#include <cmath>
#include <vector>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

constexpr double degree = 0.017453292519943295;

/// ArduCopter's defaults: WP_SPD_UP, WP_SPD_DN, WP_ACC, WP_ACC_Z, WP_JERK, ATC_SLEW_YAW,
/// ATC_ACCEL_Y_MAX, LAND_SPEED, LAND_ALT_LOW. The jerk rises in twice ATC_INPUT_TC; the settling is
/// what six missions flown in its simulator took beyond the law (docs/flight.md).
MissionMode ardupilot_mode() {
  MissionMode mode;
  mode.law = LegLaw::s_curve;
  mode.max_ascent = 2.5, mode.max_descent = 1.5;
  mode.acceleration = 2.5, mode.vertical_acceleration = 1.0;
  mode.jerk = 1.0, mode.jerk_rise = 0.3;
  mode.settle_time = 0.47;
  mode.yaw_rate = 60 * degree, mode.yaw_acceleration = 270 * degree;
  mode.takeoff_speed = 2.5, mode.takeoff_ramp = 3.0;
  mode.landing_speed = 0.5, mode.landing_height = 10.0, mode.touchdown_time = 0.0;
  return mode;
}

/// DJI publishes top speeds and turning rates; the others are estimates.
MissionMode dji_mode() {
  MissionMode mode;
  mode.law = LegLaw::s_curve;
  mode.max_ascent = 6.0, mode.max_descent = 5.0;
  mode.acceleration = 3.0, mode.vertical_acceleration = 3.0, mode.jerk = 6.0;
  mode.yaw_rate = 100 * degree, mode.yaw_acceleration = 2.0;
  mode.takeoff_speed = 2.0;
  return mode;
}

/// Sources: makers' data sheets for speeds, mass, battery and endurance; WPML codes from DJI's
/// Cloud API documentation. Estimates: the X10 battery and mass,
/// the M350 flown mass and endurance with payload, and all drag areas and avionics powers.
std::vector<Vehicle> all_profiles() {
  std::vector<Vehicle> profiles;

  Vehicle px4;
  px4.name = "generic";
  profiles.push_back(px4);

  Vehicle ardupilot;
  ardupilot.name = "generic_ardupilot";
  ardupilot.dialect = Dialect::ardupilot;
  ardupilot.mode = ardupilot_mode();
  ardupilot.max_waypoints = 700;
  profiles.push_back(ardupilot);

  Vehicle m350;
  m350.name = "m350_rtk";
  m350.dialect = Dialect::dji;
  m350.wpml = {89, 0, 42, "1.0.6", true};  // payload: Zenmuse H20
  m350.mode = dji_mode();
  m350.radius = 0.72;
  m350.max_speed = 15.0;
  m350.gimbal_rate = 90 * degree;
  m350.gimbal_min = -120 * degree, m350.gimbal_max = 30 * degree;
  m350.max_wind = 12.0;
  m350.mass = 7.3, m350.rotor_diameter = 0.533, m350.battery_wh = 526.4;
  m350.endurance_min = 43.0, m350.avionics_power = 50.0, m350.drag_area = 0.12;
  m350.max_waypoints = 65535;
  profiles.push_back(m350);

  Vehicle m30t = m350;
  m30t.name = "m30t";
  m30t.wpml = {67, 1, 53, "1.0.6", true};
  m30t.radius = 0.54;
  m30t.gimbal_max = 45 * degree;
  m30t.mass = 3.77, m30t.rotor_diameter = 0.406, m30t.battery_wh = 263.2;
  m30t.endurance_min = 41.0, m30t.avionics_power = 30.0, m30t.drag_area = 0.06;
  profiles.push_back(m30t);

  Vehicle mavic = m30t;
  mavic.name = "mavic_3e";
  mavic.wpml = {77, 0, 66, "1.0.6", false};
  mavic.radius = 0.32;
  mavic.gimbal_min = -90 * degree, mavic.gimbal_max = 35 * degree;
  mavic.mass = 0.915, mavic.rotor_diameter = 0.239, mavic.battery_wh = 77.0;
  mavic.endurance_min = 45.0, mavic.avionics_power = 12.0, mavic.drag_area = 0.02;
  profiles.push_back(mavic);

  Vehicle m4e = mavic;
  m4e.name = "matrice_4e";
  m4e.wpml = {99, 0, 88, "1.0.6", false};
  m4e.radius = 0.38;
  m4e.mode.max_ascent = 10.0, m4e.mode.max_descent = 8.0;
  m4e.mass = 1.22, m4e.rotor_diameter = 0.274, m4e.battery_wh = 99.5;
  m4e.endurance_min = 49.0, m4e.avionics_power = 15.0, m4e.drag_area = 0.025;
  profiles.push_back(m4e);

  Vehicle x10;
  x10.name = "skydio_x10";
  x10.radius = 0.42;
  x10.max_speed = 16.0;
  x10.mode.max_ascent = 6.0, x10.mode.max_descent = 4.0;
  x10.gimbal_max = 45 * degree;
  x10.max_wind = 12.8;
  x10.mass = 2.1, x10.rotor_diameter = 0.279, x10.battery_wh = 150.0;
  x10.endurance_min = 40.0, x10.avionics_power = 25.0, x10.drag_area = 0.03;
  profiles.push_back(x10);
  return profiles;
}

}  // namespace

void Vehicle::validate() const {
  const auto require = [&](bool holds, const std::string& field, double value,
                           const std::string& right) {
    if (holds && std::isfinite(value)) return;
    throw Error(ErrorKind::bad_config, "vehicle \"" + name + "\": " + field + " is " +
                                           std::to_string(value) + "; it must be " + right);
  };
  const auto positive = [&](double value, const std::string& field) {
    require(value > 0.0, field, value, "positive");
  };
  positive(radius, "radius"), positive(max_speed, "max_speed");
  positive(gimbal_rate, "gimbal_rate");
  positive(mass, "mass"), positive(rotor_diameter, "rotor_diameter");
  positive(battery_wh, "battery_wh"), positive(endurance_min, "endurance_min");
  positive(rotors, "rotors"), positive(max_waypoints, "max_waypoints");
  require(avionics_power >= 0.0, "avionics_power", avionics_power, "zero or more");
  require(drag_area >= 0.0, "drag_area", drag_area, "zero or more");
  require(max_wind >= 0.0, "max_wind", max_wind, "zero or more");
  require(energy_error >= 0.0 && energy_error < 1.0, "energy_error", energy_error, "in [0, 1)");
  require(gimbal_min < gimbal_max, "gimbal_min", gimbal_min, "below gimbal_max");
  mode.validate(name);
}

std::span<const Vehicle> vehicle_profiles() {
  static const std::vector<Vehicle> profiles = all_profiles();
  return profiles;
}

const Vehicle& vehicle_profile(const std::string& name) {
  std::string names;
  for (const Vehicle& vehicle : vehicle_profiles()) {
    if (vehicle.name == name) return vehicle;
    names += (names.empty() ? "" : ", ") + vehicle.name;
  }
  throw Error(ErrorKind::bad_config, "vehicle \"" + name + "\" is not known; there are " + names);
}

}  // namespace skycap::flight
