/// Model of how an autopilot flies the legs of a mission: motion limits, stops, take-off and
/// landing. These are parameters of the autopilot, not of the airframe. With a different autopilot
/// the same vehicle can take 1.5 times as long for the same route.
#pragma once

#include <string>

namespace skycap::flight {

/// Motion law of a leg between two stops.
enum class LegProfile {
  s_curve,  ///< ArduCopter: limited jerk, whose rise takes `jerk_rise`.
  /// PX4: speed limited by the remaining distance until the waypoint is accepted.
  braking_distance,
};

/// Mission mode of an autopilot. The defaults are those of PX4.
struct MissionMode {
  LegProfile leg_profile = LegProfile::braking_distance;
  double max_ascent = 3.0;             ///< Maximum climb speed [m/s].
  double max_descent = 1.5;            ///< Maximum descent speed [m/s].
  double acceleration = 3.0;           ///< Horizontal acceleration [m/s^2].
  double vertical_acceleration = 3.0;  ///< Vertical acceleration [m/s^2].
  double jerk = 4.0;                   ///< Jerk limit in any direction [m/s^3].
  /// Duration of the raised-cosine rise from zero jerk to the limit (s_curve only) [s].
  double jerk_rise = 0.0;
  /// Additional time at each stop, for lag and for waypoint acceptance [s].
  double settle_time = 1.0;
  double yaw_rate = 1.0471975511965976;  ///< Maximum yaw rate [rad/s].
  double yaw_acceleration = 0.349;       ///< Yaw acceleration [rad/s^2].

  double takeoff_speed = 1.5;  ///< Climb speed during take-off [m/s].
  double takeoff_ramp = 3.0;   ///< Additional time for motor spin-up, acceleration and braking [s].
  double landing_speed = 0.7;  ///< Descent speed below `landing_height` [m/s].
  double landing_height = 5.0;  ///< Height above the pad at which the final descent starts [m].
  double touchdown_time = 2.0;  ///< Time from touchdown until the motors stop [s].

  /// Throws Error{bad_config} with `owner` and the name of the first field outside its interval.
  void validate(const std::string& owner) const;
};

/// Returns the distance from the current position to ArduCopter's stopping point at `speed` [m/s],
/// where a return starts (AC_PosControl.cpp, stopping_distance(), with PSC_POSXY_P 1) [m]. PX4 and
/// DJI vehicles brake over a shorter distance.
double braking_distance(const MissionMode& mode, double speed);

/// Returns the maximum distance by which the stopping point of a return that begins shortly before
/// a stop lies beyond this stop [m]. ArduCopter computes the stopping point from the speed only,
/// whereas it is already braking with an S-curve (mode_rtl.cpp, AC_PosControl.cpp).
double return_overshoot(const MissionMode& mode);

/// Motion limits of one straight leg.
struct LegLimits {
  double speed = 0.0;         ///< Maximum speed [m/s].
  double acceleration = 0.0;  ///< Maximum acceleration [m/s^2].
};

/// Acceptance radius of waypoints in exported PX4 files [m].
inline constexpr double acceptance_radius = 0.3;

/// Returns the rest-to-rest duration of ArduCopter's S-curve [s], 0 for zero distance. With
/// `jerk_rise` = 0 the seven phases have constant jerk.
///
/// Exact for the law in AP_Math/SCurve.cpp, calculate_path(). If length and speed allow the full
/// acceleration, the duration is distance / speed + speed / acceleration + acceleration / jerk +
/// jerk_rise.
double s_curve_time(double distance, const LegLimits& limits, double jerk, double jerk_rise);

/// Returns the time from rest until PX4 accepts the waypoint [s], 0 within the acceptance radius.
///
/// Acceleration is limited by jerk. The braking speed v at distance d satisfies v^2 + 4 a^2 / j v =
/// 2 a d (PX4 motion_planning, computeMaxSpeedFromDistance). The model excludes the setpoint's wait
/// for a lagging vehicle, which `settle_time` covers.
double braking_distance_time(double distance, const LegLimits& limits, double jerk);

}  // namespace skycap::flight
