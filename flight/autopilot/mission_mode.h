/// How an autopilot flies the legs of a mission: its limits, and what stops, take-off and landing
/// take. These are parameters of the autopilot, not of the airframe: the same vehicle takes half as
/// long again for the same route with another one.
#pragma once

#include <string>

namespace skycap::flight {

/// The law that legs from stop to stop follow.
enum class LegLaw {
  s_curve,           ///< ArduCopter: jerk limited, and the jerk itself rises in `jerk_rise`
  braking_distance,  ///< PX4: the speed follows from the distance left, until it is near enough
};

/// The defaults are PX4's.
struct MissionMode {
  LegLaw law = LegLaw::braking_distance;
  double max_ascent = 3.0;             ///< [m/s]
  double max_descent = 1.5;            ///< [m/s]
  double acceleration = 3.0;           ///< horizontal [m/s^2]
  double vertical_acceleration = 3.0;  ///< [m/s^2]
  double jerk = 4.0;                   ///< in any direction [m/s^3]
  double jerk_rise = 0.0;              ///< of s_curve: raised cosine from no jerk to the limit [s]
  double settle_time =
      1.0;  ///< at each stop beyond the law: lag, and waiting to be near enough [s]
  double yaw_rate = 1.0471975511965976;  ///< [rad/s]
  double yaw_acceleration = 0.349;       ///< [rad/s^2]

  double takeoff_speed = 1.5;   ///< [m/s]
  double takeoff_ramp = 3.0;    ///< what spinning up, accelerating and stopping add [s]
  double landing_speed = 0.7;   ///< of the last metres [m/s]
  double landing_height = 5.0;  ///< which begin so high above the pad [m]
  double touchdown_time = 2.0;  ///< until it has noticed that it stands, and stops its motors [s]

  /// Throws Error{bad_config} naming the first field that is out of its interval, and `owner`.
  void validate(const std::string& owner) const;
};

/// The limits of one straight leg.
struct LegLimits {
  double speed = 0.0;         ///< [m/s]
  double acceleration = 0.0;  ///< [m/s^2]
};

/// How near to a waypoint PX4 counts it as reached, as our files tell it [m].
inline constexpr double acceptance_radius = 0.3;

/// From rest to rest by ArduCopter's S-curve; zero for no distance. `jerk_rise` 0 leaves the seven
/// phases of constant jerk. Exact for its law (AP_Math/SCurve.cpp, calculate_path): where length
/// and speed let the acceleration reach its limit it is distance / speed + speed / acceleration +
/// acceleration / jerk + jerk_rise.
double s_curve_time(double distance, const LegLimits& limits, double jerk, double jerk_rise);

/// From rest until PX4 counts the place as reached; zero nearer than that. Speeding up is jerk
/// limited; braking keeps to v^2 + 4 a^2 / j v = 2 a d at d from the place
/// (motion_planning, computeMaxSpeedFromDistance). Not reproduced: how the setpoint waits for a
/// vehicle that lags behind, which is in `settle_time`.
double braking_distance_time(double distance, const LegLimits& limits, double jerk);

}  // namespace skycap::flight
