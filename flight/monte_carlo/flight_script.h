/// Time-stamped flight commands: straight legs with waits in between.
///
/// The motion along a leg is that of rest_to_rest_state(), in the time of the autopilot's leg law.
/// Legs between waypoints that are passed without a stop are divided into short pieces of constant
/// acceleration, with a parabola at each corner.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/interpreter/interpreted_route.h"
#include "flight/monte_carlo/vehicle_model.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// Straight leg from rest to rest, or a piece of a continuous flight.
struct ScriptedLeg {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  double moving = 0.0;                 ///< Time in motion [s].
  double wait = 0.0;                   ///< Wait at the end for settling, rotation and captures [s].
  double speed = 0.0;                  ///< Speed limit [m/s].
  double acceleration = 0.0;           ///< Acceleration limit [m/s^2].
  bool is_over_pad = false;            ///< True above the pad, where the ground is not an obstacle.
  std::array<std::string, 2> items{};  ///< Mission items at the start and end of the leg.
  bool is_piece = false;               ///< Piece of a continuous flight, without rest at its ends.
  double begin_speed = 0.0, end_speed = 0.0;  ///< Of a piece [m/s].

  double duration() const { return moving + wait; }
};

using FlightScript = std::vector<ScriptedLeg>;

/// Returns the duration of the script [s].
double duration(const FlightScript& script);

/// Returns the setpoint at `time` [s] after the start of the leg, waits included.
SetPoint set_point(const ScriptedLeg& leg, double jerk, double time);

/// Returns the setpoint `braking` [s] after a leg was aborted at `time` [s]. The vehicle brakes
/// along the leg with its acceleration, at most to its end. On a piece of a continuous flight it
/// brakes straight on, also beyond the end of the piece.
SetPoint braking_point(const ScriptedLeg& leg, double jerk, double time, double braking);

/// Returns the braking time after an abort at `time` [s].
double braking_time(const ScriptedLeg& leg, double jerk, double time);

/// Return the braking time and the setpoint `braking` [s] after the autopilot of `vehicle` has
/// interrupted the leg at `time` [s], for example for a return. PX4 and DJI vehicles brake as in
/// braking_point(). ArduCopter computes its stopping point from the speed only
/// (flight::braking_distance()), so that it passes a stop by up to return_overshoot().
double recall_time(const ScriptedLeg& leg, const Vehicle& vehicle, double time);
SetPoint recall_point(const ScriptedLeg& leg, const Vehicle& vehicle, double time, double braking);

/// Returns a leg from rest to rest with the duration from `motion`, without a wait.
ScriptedLeg scripted_leg(const Motion& motion, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& to);

/// Returns a part of the descent from `from` to z = `end`, above ground at z = `foot` [m]. Near the
/// ground it uses the landing speed. If it ends on the ground, it lasts until the motors stop.
ScriptedLeg landing_leg(const Motion& motion, const Eigen::Vector3d& from, double end, double foot);

/// Returns the flight of a route file with the vehicle of `motion`. Legs with several possible
/// start positions follow a corner that is passed: it is rounded by a parabola from the earliest
/// departure, or from the middle of a leg if that is later.
FlightScript make_flight_script(const InterpretedRoute& route, const Motion& motion);

}  // namespace skycap::flight
