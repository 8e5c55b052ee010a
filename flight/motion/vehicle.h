/// Vehicle profile: speeds, size, gimbal, battery and file codes. Profiles are data files:
/// flight/motion/presets/*.yaml, or a user's file next to the mission.
#pragma once

#include <string>

#include "flight/autopilot/mission_mode.h"

namespace skycap::flight {

/// Dialect of mission items that an autopilot supports.
enum class AutopilotType { px4, ardupilot, dji };

/// App that flies the missions of a DJI vehicle. The apps of consumer drones (fly, litchi) accept a
/// small number of waypoints and need one waypoint per photo.
enum class MissionApp { pilot, fly, litchi };
/// Returns the name of the app: "DJI Pilot 2", "DJI Fly" or "Litchi".
const char* to_string(MissionApp app);

/// Codes of vehicle and payload in DJI WPML files.
struct WpmlCodes {
  int drone = 0;
  int drone_variant = 0;
  int payload = 0;
  std::string version = "1.0.6";  ///< Version of the XML namespace that the firmware supports.
};

/// Vehicle profile in SI units. Angles are in radians; energies are in Wh where data sheets use
/// them.
struct Vehicle {
  std::string name;
  AutopilotType autopilot = AutopilotType::px4;
  MissionApp app = MissionApp::pilot;  ///< Only for DJI vehicles.
  WpmlCodes wpml;
  MissionMode mode;  ///< How the autopilot flies missions.

  double radius = 0.5;       ///< Distance from the centre to the outermost propeller tip [m].
  double max_speed = 10.0;   ///< Maximum horizontal speed and airspeed [m/s].
  double gimbal_rate = 1.0;  ///< Maximum gimbal rate [rad/s].
  double gimbal_min = -1.5707963267948966;  ///< Minimum pitch [rad], 0 at the horizon.
  double gimbal_max = 0.5;                  ///< Maximum pitch [rad].
  double max_wind = 10.0;                   ///< Maximum wind speed [m/s].
  double sway_speed = 0.1;                  ///< Hover drift speed [m/s].
  double sway_rate = 0.0087;                ///< Residual camera rotation rate in hover [rad/s].
  double position_error = 0.1;  ///< Maximum navigation error of the positioning system [m].

  double mass = 2.0;  ///< Take-off mass with payload [kg].
  int rotors = 4;
  double rotor_diameter = 0.3;  ///< Rotor diameter [m].
  double battery_wh = 100.0;    ///< Energy of all batteries together [Wh].
  /// Data sheet endurance at `mass`, which calibrates the efficiency [min].
  double endurance_min = 30.0;
  double avionics_power = 20.0;  ///< Power of electronics and payload [W].
  double drag_area = 0.03;       ///< Drag coefficient times frontal area [m^2].
  double energy_error = 0.1;     ///< Maximum relative excess of actual over predicted energy.

  /// Maximum number of waypoints (DJI vehicles) or mission items per mission file.
  int max_waypoints = 500;

  /// Returns true if the app needs a waypoint, with a stop, for each photo.
  bool needs_waypoint_per_photo() const { return app != MissionApp::pilot; }

  /// Throws Error{bad_config} naming the first field outside its interval.
  void validate() const;
};

/// Returns the maximum distance by which the vehicle passes a stop if the mission is interrupted
/// shortly before it: return_overshoot() with ArduCopter, otherwise zero [m].
double stop_overshoot(const Vehicle& vehicle);

}  // namespace skycap::flight
