/// What a vehicle can do: speeds, size, gimbal, battery, and what its ground station accepts.
/// Profiles are data: flight/motion/presets/*.yaml, and what a user writes beside a mission.
#pragma once

#include <string>

#include "flight/autopilot/mission_mode.h"

namespace skycap::flight {

/// The kind of mission items an autopilot understands.
enum class Dialect { px4, ardupilot, dji };

/// Numbers that DJI's WPML files name a vehicle and its payload by.
struct WpmlCodes {
  int drone = 0;
  int drone_variant = 0;
  int payload = 0;
  std::string version = "1.0.6";  ///< of the namespace that the firmware reads
};

/// SI units; angles in radians; energies in watt hours where the data sheets use them.
struct Vehicle {
  std::string name;
  Dialect dialect = Dialect::px4;
  WpmlCodes wpml;
  MissionMode mode;  ///< how its autopilot flies

  double radius = 0.5;                      ///< from the centre to the farthest propeller tip [m]
  double max_speed = 10.0;                  ///< horizontal, and through the air [m/s]
  double gimbal_rate = 1.0;                 ///< [rad/s]
  double gimbal_min = -1.5707963267948966;  ///< lowest pitch [rad], 0 is the horizon
  double gimbal_max = 0.5;                  ///< highest pitch [rad]
  double max_wind = 10.0;                   ///< [m/s]
  double sway_speed = 0.1;                  ///< at which it still moves when it stands [m/s]
  double sway_rate = 0.0087;                ///< at which its camera still turns then [rad/s]
  double position_error = 0.1;              ///< maximum navigation error, by its positioning [m]

  double mass = 2.0;  ///< flown, with payload [kg]
  int rotors = 4;
  double rotor_diameter = 0.3;   ///< [m]
  double battery_wh = 100.0;     ///< of all batteries together
  double endurance_min = 30.0;   ///< data sheet, at `mass`: calibrates the efficiency
  double avionics_power = 20.0;  ///< electronics and payload [W]
  double drag_area = 0.03;       ///< drag coefficient times frontal area [m^2]
  double energy_error = 0.1;     ///< share that flights may take more than the model says

  int max_waypoints = 500;  ///< in one mission file

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

}  // namespace skycap::flight
