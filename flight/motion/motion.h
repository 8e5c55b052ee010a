/// Time and energy of straight rest-to-rest legs.
///
/// Time: the autopilot's leg law (flight/autopilot/mission_mode.h) with the limits of the slower of
/// the horizontal and vertical axes, plus the settle time. Yaw and gimbal rotate during the leg.
///
/// Energy: momentum theory of a rotor in forward flight plus profile and parasite power (Liu et al.
/// 2017; Bauersfeld & Scaramuzza 2022). Hover power is calibrated with the endurance of the data
/// sheet.
#pragma once

#include <Eigen/Core>

#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Weather and the pilot's settings.
struct Conditions {
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< Air velocity, east and north [m/s].
  double air_density = 1.225;                      ///< Air density [kg/m^3].
  double temperature_c = 15.0;                     ///< Battery temperature [°C].
  double cruise_speed = 4.0;                       ///< Desired speed on legs [m/s].
  double reserve = 0.25;  ///< Fraction of the battery energy that remains at landing, in [0, 1).
  /// Maximum ratio of actual to predicted flight time, at least 1. The battery must suffice for a
  /// sortie of that duration (flight_time_range.h).
  double longest_flight = 1.0;

  /// Throws Error{bad_config} naming the first value that is outside its interval or exceeds the
  /// vehicle's limits.
  void validate(const Vehicle& vehicle) const;
};

/// Returns the rest-to-rest time over `distance` [m] with limited speed, acceleration and jerk (all
/// positive) [s]. Seven-phase profile of Biagiotti & Melchiorri, Trajectory Planning for Automatic
/// Machines and Robots, section 3.4. It is a lower bound for the autopilots' leg laws.
double rest_to_rest_time(double distance, double speed, double acceleration, double jerk);

/// State of the seven-phase motion: distance [m], speed [m/s] and acceleration [m/s^2].
/// rest_to_rest_state() returns it `time` [s] after the start; after the end, it is at rest at
/// `distance`.
struct MotionState {
  double distance = 0.0, speed = 0.0, acceleration = 0.0;
};
MotionState rest_to_rest_state(double distance, double speed, double acceleration, double jerk,
                               double time);

/// Returns the rest-to-rest time of a rotation by `angle` (either sign) with limited rate and
/// acceleration [s].
double turn_time(double angle, double rate, double acceleration);

/// Returns the acceleration in `direction` (unit vector) within the horizontal and vertical limits
/// [m/s^2].
double acceleration_along(const MissionMode& mode, const Eigen::Vector3d& direction);

/// Returns the distance over which the autopilot brings the vehicle to rest from `velocity` [m/s]
/// if the mission is interrupted, for example by a return [m]. DJI and PX4 vehicles brake with the
/// acceleration of the mission mode, ArduCopter as in braking_distance().
double stopping_distance(const Vehicle& vehicle, const Eigen::Vector3d& velocity);

/// Time and energy model of one vehicle in given conditions.
class Motion {
 public:
  /// Throws the same errors as Vehicle::validate() and Conditions::validate().
  Motion(const Vehicle& vehicle, const Conditions& conditions);

  const Vehicle& vehicle() const { return vehicle_; }
  const Conditions& conditions() const { return conditions_; }

  /// Returns the speed on a leg in `direction` (unit vector) [m/s]: the cruise speed, or less where
  /// the vertical limits or the airspeed limit against the wind require it.
  double leg_speed(const Eigen::Vector3d& direction) const;

  /// Returns the acceleration along a leg in `direction` (unit vector) within the horizontal and
  /// vertical limits [m/s^2].
  double leg_acceleration(const Eigen::Vector3d& direction) const;

  /// Returns the time from one stop to the next along a straight line, including the settle time
  /// [s]. 0 for zero displacement.
  double leg_time(const Eigen::Vector3d& displacement) const;

  /// Returns the time from leaving a stop until the camera is aimed after a rotation by `yaw` and
  /// `pitch` [rad], at least `leg` [s]. DJI gimbals rotate only on arrival, as a waypoint action.
  double aimed_time(double leg, double yaw, double pitch) const;

  /// Returns the time for the vertical climb from the pad to rest, or for the vertical descent from
  /// rest until the motors stop [s].
  double takeoff_time(double climb) const;
  double landing_time(double descent) const;
  double takeoff_energy(double climb) const;  ///< Returns the electrical energy of the climb [J].

  /// Returns the electrical energy [J] of a straight leg flown in `duration` [s], which must be at
  /// least leg_time(). The vehicle hovers for the remaining time.
  double leg_energy(const Eigen::Vector3d& displacement, double duration) const;

  /// Returns the electrical power of steady flight at a ground velocity, including climb [W].
  double flight_power(const Eigen::Vector3d& velocity) const;
  /// Returns the energy loss of braking from `speed` [m/s] to rest [J].
  double stopping_energy(double speed) const;

  double hover_power() const;                   ///< In still air [W].
  double forward_power(double airspeed) const;  ///< Level flight [W].
  double hover_energy(double duration) const;   ///< Holding position in the wind [J].
  /// Returns the energy of full batteries above the reserve [J]. It is reduced by the relative
  /// model error Vehicle::energy_error.
  double usable_energy() const;

 private:
  /// Returns the time until rest or waypoint acceptance, depending on the autopilot [s].
  double moving_time(const Eigen::Vector3d& displacement) const;

  Vehicle vehicle_;
  Conditions conditions_;
  double induced_power_;  ///< Electrical, in hover [W].
  double profile_power_;  ///< Electrical, in hover [W].
  double induced_speed_;  ///< v0 = sqrt(T / (2 rho A)) in hover [m/s].
  double efficiency_;     ///< Combined efficiency of shaft, motor and controller.
};

}  // namespace skycap::flight
