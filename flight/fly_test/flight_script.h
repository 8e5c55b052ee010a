/// What a vehicle is told to do on a flight: straight legs in time, with waits between.
///
/// The motion along a leg is that of rest_to_rest_state() in the time that the autopilot's law
/// takes for it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/fly_test/vehicle_model.h"
#include "flight/interpreter/flown_route.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// One straight leg, from rest to rest.
struct ScriptedLeg {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  double moving = 0.0;                 ///< from rest to rest [s]
  double wait = 0.0;                   ///< at its end: to settle, turn and photograph [s]
  double speed = 0.0;                  ///< its limit [m/s]
  double acceleration = 0.0;           ///< its limit [m/s^2]
  bool is_over_pad = false;            ///< where the ground is no obstacle
  std::array<std::string, 2> items{};  ///< of the file that it leads between

  double duration() const { return moving + wait; }
};

using FlightScript = std::vector<ScriptedLeg>;

/// How long all of it takes [s].
double duration(const FlightScript& script);

/// Where the vehicle shall be `time` after the leg began, waits included.
SetPoint set_point(const ScriptedLeg& leg, double jerk, double time);

/// The set point when a leg is given up `time` after it began: braking at the leg's acceleration,
/// on it and no farther than its end, `braking` later.
SetPoint braking_point(const ScriptedLeg& leg, double jerk, double time, double braking);

/// How long that braking takes [s].
double braking_time(const ScriptedLeg& leg, double jerk, double time);

/// A leg from rest to rest in the time of `motion`, without a wait.
ScriptedLeg scripted_leg(const Motion& motion, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& to);

/// A part of the descent to the ground at z = `foot`, from where it begins down to z = `end`: at
/// the speed of landings where it is low, and until the motors stop where it ends there.
ScriptedLeg landing_leg(const Motion& motion, const Eigen::Vector3d& from, double end, double foot);

/// The flight of a route that was read from a file, as the vehicle of `motion` flies it. Legs that
/// may begin in several places begin in the last of them.
FlightScript script_of(const FlownRoute& route, const Motion& motion);

}  // namespace skycap::flight
