/// How long a straight leg takes from rest to rest, and what it costs in energy.
///
/// Time: the law of the vehicle's autopilot (flight/autopilot/mission_mode.h) along the leg, whose
/// limits are those of the slower of the horizontal and the vertical axis; then it settles. Yaw and
/// gimbal turn meanwhile.
///
/// Energy: momentum theory of a rotor in forward flight plus profile and parasite power (Liu et al.
/// 2017; Bauersfeld & Scaramuzza 2022); hover power is calibrated to the data sheet's endurance.
#pragma once

#include <Eigen/Core>

#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Weather, and how the pilot flies.
struct Conditions {
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< velocity of the air, east and north [m/s]
  double air_density = 1.225;                      ///< [kg/m^3]
  double temperature_c = 15.0;                     ///< of the battery
  double cruise_speed = 4.0;                       ///< wanted on legs [m/s]
  double reserve = 0.25;  ///< share of the battery that is left at landing, in [0, 1)
  /// Flights may take so many times as long as predicted, 1 or more: each sortie must fit its
  /// battery then (flight_time_range.h).
  double longest_flight = 1.0;

  /// Throws Error{bad_config} naming the first value that is out of its interval or that the
  /// vehicle cannot fly in.
  void validate(const Vehicle& vehicle) const;
};

/// From rest to rest over `distance` under limits of speed, acceleration and jerk (all positive):
/// the profile of seven phases (Biagiotti & Melchiorri, Trajectory Planning for Automatic Machines
/// and Robots, section 3.4). No autopilot's law below is faster.
double rest_to_rest_time(double distance, double speed, double acceleration, double jerk);

/// Where such a motion is after `time`; at rest at the end from then on.
struct MotionState {
  double distance = 0.0, speed = 0.0, acceleration = 0.0;
};
MotionState rest_to_rest_state(double distance, double speed, double acceleration, double jerk,
                               double time);

/// Turning by `angle` (either sign) under limits of rate and acceleration, from rest to rest.
double turn_time(double angle, double rate, double acceleration);

/// Time and energy model of one vehicle in given conditions.
class Motion {
 public:
  /// Throws what Vehicle::validate() and Conditions::validate() throw.
  Motion(const Vehicle& vehicle, const Conditions& conditions);

  const Vehicle& vehicle() const { return vehicle_; }
  const Conditions& conditions() const { return conditions_; }

  /// Speed that a leg in this direction (unit) is flown at: the cruise speed, unless the vertical
  /// limits or the airspeed limit against the wind are lower.
  double leg_speed(const Eigen::Vector3d& direction) const;

  /// Acceleration along a leg in this direction (unit), within the horizontal and vertical limits.
  double leg_acceleration(const Eigen::Vector3d& direction) const;

  /// From one stop to the next along a straight piece, until settled; zero for no displacement.
  double leg_time(const Eigen::Vector3d& displacement) const;

  /// From leaving a stop after which the camera turns by `yaw` and `pitch` until it looks right,
  /// `leg` later at the least [s]. DJI's gimbals turn on arrival only, as an action there.
  double aimed_time(double leg, double yaw, double pitch) const;

  /// Straight up from the pad to rest, and from rest straight down until the motors stop.
  double takeoff_time(double climb) const;
  double landing_time(double descent) const;
  double takeoff_energy(double climb) const;  ///< [J]

  /// Electrical energy of that piece, flown in `duration`, at least leg_time() [J]. The surplus is
  /// spent hovering.
  double leg_energy(const Eigen::Vector3d& displacement, double duration) const;

  /// Electrical power of flying steadily at a velocity over the ground, climbing included [W].
  double flight_power(const Eigen::Vector3d& velocity) const;
  /// What is lost in stopping from a speed [J].
  double stopping_energy(double speed) const;

  double hover_power() const;                   ///< in still air [W]
  double forward_power(double airspeed) const;  ///< level flight [W]
  double hover_energy(double duration) const;   ///< holding position in the wind [J]
  /// Of full batteries, above the reserve, and if flights take as much more than this model says
  /// as the vehicle's energy_error allows [J].
  double usable_energy() const;

 private:
  /// Until at rest, or as near as its autopilot asks.
  double moving_time(const Eigen::Vector3d& displacement) const;

  Vehicle vehicle_;
  Conditions conditions_;
  double induced_power_;  ///< electrical, in hover
  double profile_power_;  ///< electrical, in hover
  double induced_speed_;  ///< v0 = sqrt(T / (2 rho A)) in hover
  double efficiency_;     ///< shaft, motor and controller together
};

}  // namespace skycap::flight
