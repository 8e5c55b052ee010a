#include "tests/flight/vehicles.h"

#include <stdexcept>
#include <vector>

#include "geometry/angle.h"

namespace skycap::flight {
namespace {

constexpr double degree = geometry::radians_per_degree;

MissionMode ardupilot_mode() {
  MissionMode mode;
  mode.leg_profile = LegProfile::s_curve;
  mode.max_ascent = 2.5, mode.max_descent = 1.5;
  mode.acceleration = 2.5, mode.vertical_acceleration = 1.0;
  mode.jerk = 1.0, mode.jerk_rise = 0.3;
  mode.settle_time = 0.47;
  mode.yaw_rate = 60 * degree, mode.yaw_acceleration = 270 * degree;
  mode.takeoff_speed = 2.5, mode.takeoff_ramp = 3.0;
  mode.landing_speed = 0.5, mode.landing_height = 10.0, mode.touchdown_time = 0.0;
  return mode;
}

MissionMode dji_mode() {
  MissionMode mode;
  mode.leg_profile = LegProfile::s_curve;
  mode.max_ascent = 6.0, mode.max_descent = 5.0;
  mode.acceleration = 3.0, mode.vertical_acceleration = 3.0, mode.jerk = 6.0;
  mode.yaw_rate = 100 * degree, mode.yaw_acceleration = 2.0;
  mode.takeoff_speed = 2.0;
  return mode;
}

std::vector<Vehicle> test_vehicles() {
  Vehicle px4;
  px4.name = "generic";

  Vehicle ardupilot;
  ardupilot.name = "generic_ardupilot";
  ardupilot.autopilot = AutopilotType::ardupilot;
  ardupilot.mode = ardupilot_mode();
  ardupilot.max_waypoints = 700;

  Vehicle m350;
  m350.name = "m350_rtk";
  m350.autopilot = AutopilotType::dji;
  m350.wpml = {89, 0, 42, "1.0.6"};
  m350.mode = dji_mode();
  m350.radius = 0.72, m350.max_speed = 15.0, m350.max_wind = 12.0;
  m350.gimbal_rate = 90 * degree;
  m350.gimbal_min = -120 * degree, m350.gimbal_max = 30 * degree;
  m350.mass = 7.3, m350.rotor_diameter = 0.533, m350.battery_wh = 526.4;
  m350.endurance_min = 43.0, m350.avionics_power = 50.0, m350.drag_area = 0.12;
  m350.max_waypoints = 65535;

  Vehicle m30t = m350;
  m30t.name = "m30t";
  m30t.wpml = {67, 1, 53, "1.0.6"};
  m30t.radius = 0.54;
  m30t.mass = 3.77, m30t.rotor_diameter = 0.406, m30t.battery_wh = 263.2;
  m30t.endurance_min = 41.0, m30t.avionics_power = 30.0, m30t.drag_area = 0.06;
  return {px4, ardupilot, m350, m30t};
}

}  // namespace

std::span<const Vehicle> vehicle_profiles() {
  static const std::vector<Vehicle> vehicles = test_vehicles();
  return vehicles;
}

const Vehicle& vehicle_profile(const std::string& name) {
  for (const Vehicle& vehicle : vehicle_profiles()) {
    if (vehicle.name == name) return vehicle;
  }
  throw std::logic_error("the tests have no vehicle " + name);
}

}  // namespace skycap::flight
