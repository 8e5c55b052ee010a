#include "flight/fly_test/flight_script.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "flight/autopilot/mission_mode.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns the shorter rotation between two headings [rad], 0 if one is not given.
double turn_between(double from_deg, double to_deg) {
  if (std::isnan(from_deg) || std::isnan(to_deg)) return 0.0;
  return std::remainder(to_deg - from_deg, 360.0) * geometry::radians_per_degree;
}

/// Converts a route's pieces and stops to a script.
class ScriptWriter {
 public:
  ScriptWriter(const FlownRoute& route, const Motion& motion) : route_(route), motion_(motion) {}

  FlightScript write() {
    for (std::size_t i = 0; i < route_.pieces.size(); ++i) {
      const FlownPiece& piece = route_.pieces[i];
      ScriptedLeg leg = leg_of(i, script_.empty() ? piece.start.to : script_.back().to);
      leg.is_over_pad = piece.is_over_pad;
      leg.items = {piece.from_item, piece.to_item};
      leg.wait += piece.hold + turning(piece, leg.moving);
      script_.push_back(std::move(leg));
    }
    return std::move(script_);
  }

 private:
  ScriptedLeg leg_of(std::size_t i, const Vector3d& from) {
    const FlownPiece& piece = route_.pieces[i];
    const double settling = motion_.vehicle().mode.settle_time;
    if (is_landing(i)) return landing_leg(motion_, from, piece.to.z(), route_.pieces.back().to.z());
    ScriptedLeg leg = scripted_leg(motion_at(piece.speed), from, piece.to);
    if (leg.moving > 0.0) leg.wait = settling;
    if (piece.is_over_pad) {
      leg.moving = std::max(leg.moving, motion_.takeoff_time((piece.to - from).norm()) - settling);
    }
    return leg;
  }

  /// Returns true if a piece is vertically downwards and is the last one, or continues into the
  /// last one.
  bool is_landing(std::size_t i) const {
    const auto is_down = [&](const FlownPiece& piece) {
      const Vector3d way = piece.to - piece.start.to;
      return way.z() < 0.0 && way.head<2>().norm() == 0.0;
    };
    const std::size_t last = route_.pieces.size() - 1;
    if (!route_.pieces[last].is_over_pad || !is_down(route_.pieces[last])) return false;
    return i == last || (i + 1 == last && is_down(route_.pieces[i]));
  }

  /// Returns the additional time of vehicle and gimbal rotation beyond the leg [s], for which
  /// MAVLink missions wait.
  double turning(const FlownPiece& piece, double moving) {
    if (next_stop_ == route_.stops.size()) return 0.0;
    const FlownStop& stop = route_.stops[next_stop_];
    if (stop.item != piece.to_item || !stop.position.isApprox(piece.to)) return 0.0;
    ++next_stop_;
    const double yaw = turn_between(yaw_deg_, stop.yaw_deg);
    const double pitch = turn_between(pitch_deg_, stop.pitch_deg);
    yaw_deg_ = stop.yaw_deg, pitch_deg_ = stop.pitch_deg;
    if (motion_.vehicle().dialect != Dialect::dji) return 0.0;
    return motion_.aimed_time(moving, yaw, pitch) - moving;
  }

  /// Returns the vehicle's motion at the speed set in the file, if it is lower than that of the
  /// mission.
  const Motion& motion_at(double speed) {
    if (std::isnan(speed) || speed >= motion_.conditions().cruise_speed) return motion_;
    Conditions conditions = motion_.conditions();
    conditions.cruise_speed = speed;
    return motions_.try_emplace(speed, motion_.vehicle(), conditions).first->second;
  }

  const FlownRoute& route_;
  const Motion& motion_;
  std::map<double, Motion> motions_;
  FlightScript script_;
  std::size_t next_stop_ = 0;
  double yaw_deg_ = not_given, pitch_deg_ = not_given;
};

/// Returns the state `time` after the start of the leg. The duration is that of the leg law, the
/// shape that of seven phases.
MotionState state_on(const ScriptedLeg& leg, double jerk, double time) {
  const double distance = (leg.to - leg.from).norm();
  const double own = rest_to_rest_time(distance, leg.speed, leg.acceleration, jerk);
  if (time >= leg.moving || own == 0.0) return {distance, 0.0, 0.0};
  const double pace = own / leg.moving;
  MotionState state = rest_to_rest_state(distance, leg.speed, leg.acceleration, jerk, pace * time);
  state.speed *= pace;
  state.acceleration *= pace * pace;
  return state;
}

SetPoint at(const ScriptedLeg& leg, const MotionState& state) {
  const Vector3d way = leg.to - leg.from;
  const double length = way.norm();
  if (length == 0.0) return {leg.to};
  const Vector3d direction = way / length;
  return {leg.from + state.distance * direction, state.speed * direction,
          state.acceleration * direction};
}

}  // namespace

double duration(const FlightScript& script) {
  double sum = 0.0;
  for (const ScriptedLeg& leg : script) sum += leg.duration();
  return sum;
}

SetPoint set_point(const ScriptedLeg& leg, double jerk, double time) {
  return at(leg, state_on(leg, jerk, time));
}

double braking_time(const ScriptedLeg& leg, double jerk, double time) {
  const double speed = state_on(leg, jerk, time).speed;
  return speed > 0.0 ? speed / leg.acceleration : 0.0;
}

SetPoint braking_point(const ScriptedLeg& leg, double jerk, double time, double braking) {
  const MotionState begin = state_on(leg, jerk, time);
  const double t = std::min(braking, braking_time(leg, jerk, time));
  const double length = (leg.to - leg.from).norm();
  MotionState state{begin.distance + t * (begin.speed - 0.5 * leg.acceleration * t),
                    begin.speed - leg.acceleration * t, 0.0};
  if (state.distance >= length) state = {length, 0.0, 0.0};
  return at(leg, state);
}

ScriptedLeg scripted_leg(const Motion& motion, const Vector3d& from, const Vector3d& to) {
  ScriptedLeg leg{.from = from, .to = to};
  const Vector3d way = to - from;
  const double length = way.norm();
  if (length == 0.0) return leg;
  const MissionMode& mode = motion.vehicle().mode;
  leg.speed = motion.leg_speed(way / length);
  leg.acceleration = motion.leg_acceleration(way / length);
  leg.moving = motion.leg_time(way) - mode.settle_time;
  return leg;
}

ScriptedLeg landing_leg(const Motion& motion, const Vector3d& from, double end, double foot) {
  ScriptedLeg leg = scripted_leg(motion, from, {from.x(), from.y(), end});
  const double sinking = motion.landing_time(from.z() - foot) - motion.landing_time(end - foot);
  leg.moving = std::max(leg.moving, sinking);
  if (end <= foot) leg.wait = motion.vehicle().mode.touchdown_time;
  return leg;
}

FlightScript script_of(const FlownRoute& route, const Motion& motion) {
  return ScriptWriter(route, motion).write();
}

}  // namespace skycap::flight
