#include "flight/monte_carlo/flight_script.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "flight/autopilot/mission_mode.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Time constant of ArduCopter's position control, 1 / PSC_POSXY_P [s], and the number of time
/// constants until a vehicle counts as at rest.
constexpr double gain_time = 1.0, settled = 4.0;

/// Returns the shorter rotation between two headings [rad], 0 if one is not given.
double turn_between(double from_deg, double to_deg) {
  if (std::isnan(from_deg) || std::isnan(to_deg)) return 0.0;
  return std::remainder(to_deg - from_deg, 360.0) * geometry::radians_per_degree;
}

/// Converts a route's pieces and stops to a script.
class ScriptWriter {
 public:
  ScriptWriter(const InterpretedRoute& route, const Motion& motion)
      : route_(route), motion_(motion) {}

  FlightScript write() {
    for (std::size_t i = 0; i < route_.segments.size(); ++i) {
      const std::size_t last = last_without_stop(i);
      if (last > i) {
        append_continuous(i, last);
        i = last;
        continue;
      }
      const InterpretedSegment& segment = route_.segments[i];
      ScriptedLeg leg = make_leg(i, script_.empty() ? segment.start.to : script_.back().to);
      leg.is_over_pad = segment.is_over_pad;
      leg.items = {segment.from_item, segment.to_item};
      leg.wait += segment.hold + turning(segment, leg.moving);
      script_.push_back(std::move(leg));
    }
    return std::move(script_);
  }

 private:
  ScriptedLeg make_leg(std::size_t i, const Vector3d& from) {
    const InterpretedSegment& segment = route_.segments[i];
    const double settling = motion_.vehicle().mode.settle_time;
    if (is_landing(i))
      return landing_leg(motion_, from, segment.to.z(), route_.segments.back().to.z());
    ScriptedLeg leg = scripted_leg(motion_at(segment.speed), from, segment.to);
    if (leg.moving > 0.0) leg.wait = settling;
    if (segment.is_over_pad) {
      leg.moving =
          std::max(leg.moving, motion_.takeoff_time((segment.to - from).norm()) - settling);
    }
    return leg;
  }

  /// Returns the index of the leg at whose end the vehicle stops next.
  std::size_t last_without_stop(std::size_t i) const {
    const auto& segments = route_.segments;
    const auto is_passed = [&](std::size_t end) {
      return end + 1 < segments.size() && segments[end].hold == 0.0 &&
             segments[end + 1].start.length() > 0.0 && !segments[end].is_over_pad &&
             !segments[end + 1].is_over_pad;
    };
    while (is_passed(i)) ++i;
    return i;
  }

  /// Appends the legs from `first` to `last`, whose inner corners are passed.
  void append_continuous(std::size_t first, std::size_t last) {
    const Vector3d begin = script_.empty() ? route_.segments[first].start.to : script_.back().to;
    std::vector<ScriptedLeg> pieces;
    Vector3d at = begin, corner = begin;  // End of the last piece, and start of the leg's line.
    for (std::size_t i = first; i <= last; ++i) {
      const InterpretedSegment& segment = route_.segments[i];
      const Vector3d leg = segment.to - corner;
      corner = segment.to;
      if (leg.norm() == 0.0) continue;
      Vector3d turn_begin = segment.to, turn_end = segment.to;
      if (i < last) {
        constexpr double max_share = 0.5;
        const InterpretedSegment& next = route_.segments[i + 1];
        const Vector3d out = next.to - segment.to;
        const double before = std::min(next.start.length(), max_share * leg.norm());
        const double after = std::min(before, max_share * out.norm());
        turn_begin -= before * leg.normalized();
        if (out.norm() > 0.0) turn_end += after * out.normalized();
      }
      append_pieces(at, turn_begin, segment, pieces);
      constexpr int parts = 8;
      Vector3d from = turn_begin;
      for (int k = 1; k <= parts && i < last; ++k) {
        const double s = static_cast<double>(k) / parts;
        const Vector3d to = (1.0 - s) * (1.0 - s) * turn_begin + 2.0 * s * (1.0 - s) * segment.to +
                            s * s * turn_end;
        append_pieces(from, to, segment, pieces);
        from = to;
      }
      at = i < last ? turn_end : turn_begin;
    }
    if (pieces.empty()) return;
    set_speeds(pieces);
    pieces.back().wait = motion_.vehicle().mode.settle_time + route_.segments[last].hold +
                         turning(route_.segments[last], 0.0);
    script_.insert(script_.end(), pieces.begin(), pieces.end());
  }

  /// Appends a straight line as pieces of equal length, with the speed of `segment`.
  void append_pieces(const Vector3d& from, const Vector3d& to, const InterpretedSegment& segment,
                     std::vector<ScriptedLeg>& pieces) {
    constexpr double max_length = 0.25;
    const double length = (to - from).norm();
    const int count = static_cast<int>(std::ceil(length / max_length));
    for (int i = 0; i < count; ++i) {
      ScriptedLeg piece =
          scripted_leg(motion_at(segment.speed), from + i * (to - from) / count,
                       i + 1 < count ? Vector3d(from + (i + 1) * (to - from) / count) : to);
      piece.is_piece = true;
      piece.items = {segment.from_item, segment.to_item};
      pieces.push_back(std::move(piece));
    }
  }

  /// Sets the speeds at the ends of pieces, from rest to rest, and their times.
  static void set_speeds(std::vector<ScriptedLeg>& pieces) {
    const auto length = [](const ScriptedLeg& piece) { return (piece.to - piece.from).norm(); };
    std::vector<double> speeds(pieces.size() + 1, 0.0);
    for (std::size_t i = 1; i < pieces.size(); ++i) {
      const double reached = std::sqrt(speeds[i - 1] * speeds[i - 1] +
                                       2.0 * pieces[i - 1].acceleration * length(pieces[i - 1]));
      speeds[i] = std::min({pieces[i - 1].speed, pieces[i].speed, reached});
    }
    for (std::size_t i = pieces.size(); i-- > 0;) {
      ScriptedLeg& piece = pieces[i];
      const double braked =
          std::sqrt(speeds[i + 1] * speeds[i + 1] + 2.0 * piece.acceleration * length(piece));
      speeds[i] = std::min(speeds[i], braked);
      piece.begin_speed = speeds[i];
      piece.end_speed = speeds[i + 1];
    }
    for (ScriptedLeg& piece : pieces) {
      piece.moving = pieces.size() == 1
                         ? piece.moving
                         : 2.0 * length(piece) / (piece.begin_speed + piece.end_speed);
    }
  }

  /// Returns true if a piece is vertically downwards and is the last one, or continues into the
  /// last one.
  bool is_landing(std::size_t i) const {
    const auto is_down = [&](const InterpretedSegment& segment) {
      const Vector3d displacement = segment.to - segment.start.to;
      return displacement.z() < 0.0 && displacement.head<2>().norm() == 0.0;
    };
    const std::size_t last = route_.segments.size() - 1;
    if (!route_.segments[last].is_over_pad || !is_down(route_.segments[last])) return false;
    return i == last || (i + 1 == last && is_down(route_.segments[i]));
  }

  /// Returns the additional time of vehicle and gimbal rotation beyond the leg [s], for which
  /// MAVLink missions wait.
  double turning(const InterpretedSegment& segment, double moving) {
    if (next_stop_ == route_.stops.size()) return 0.0;
    const InterpretedStop& stop = route_.stops[next_stop_];
    if (stop.item != segment.to_item || !stop.position.isApprox(segment.to)) return 0.0;
    ++next_stop_;
    const double yaw = turn_between(yaw_deg_, stop.yaw_deg);
    const double pitch = turn_between(pitch_deg_, stop.pitch_deg);
    yaw_deg_ = stop.yaw_deg, pitch_deg_ = stop.pitch_deg;
    if (motion_.vehicle().autopilot != AutopilotType::dji) return 0.0;
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

  const InterpretedRoute& route_;
  const Motion& motion_;
  std::map<double, Motion> motions_;
  FlightScript script_;
  std::size_t next_stop_ = 0;
  double yaw_deg_ = unspecified, pitch_deg_ = unspecified;
};

/// Returns the state `time` after the start of the leg. The duration is that of the leg law, the
/// shape that of seven phases.
MotionState state_on(const ScriptedLeg& leg, double jerk, double time) {
  const double distance = (leg.to - leg.from).norm();
  if (leg.is_piece) {
    if (time >= leg.moving) return {distance, leg.end_speed, 0.0};
    const double acceleration = (leg.end_speed - leg.begin_speed) / leg.moving;
    return {time * (leg.begin_speed + 0.5 * acceleration * time),
            leg.begin_speed + acceleration * time, acceleration};
  }
  const double own = rest_to_rest_time(distance, leg.speed, leg.acceleration, jerk);
  if (time >= leg.moving || own == 0.0) return {distance, 0.0, 0.0};
  const double pace = own / leg.moving;
  MotionState state = rest_to_rest_state(distance, leg.speed, leg.acceleration, jerk, pace * time);
  state.speed *= pace;
  state.acceleration *= pace * pace;
  return state;
}

SetPoint at(const ScriptedLeg& leg, const MotionState& state) {
  const Vector3d displacement = leg.to - leg.from;
  const double length = displacement.norm();
  if (length == 0.0) return {leg.to};
  const Vector3d direction = displacement / length;
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
  const double rest = braking_time(leg, jerk, time), t = std::min(braking, rest);
  const double length = (leg.to - leg.from).norm();
  constexpr double rounding = 1e-9;
  MotionState state{begin.distance + t * (begin.speed - 0.5 * leg.acceleration * t),
                    begin.speed - leg.acceleration * t,
                    t < rest - rounding ? -leg.acceleration : 0.0};
  if (state.distance >= length && !leg.is_piece) state = {length, 0.0, 0.0};
  return at(leg, state);
}

double recall_time(const ScriptedLeg& leg, const Vehicle& vehicle, double time) {
  const double jerk = vehicle.mode.jerk;
  const double speed = state_on(leg, jerk, time).speed;
  if (vehicle.autopilot != AutopilotType::ardupilot || speed <= 0.0)
    return braking_time(leg, jerk, time);
  return std::max(0.0, speed / leg.acceleration - gain_time) + settled * gain_time;
}

SetPoint recall_point(const ScriptedLeg& leg, const Vehicle& vehicle, double time, double braking) {
  const double jerk = vehicle.mode.jerk;
  const MotionState begin = state_on(leg, jerk, time);
  if (vehicle.autopilot != AutopilotType::ardupilot || begin.speed <= 0.0)
    return braking_point(leg, jerk, time, braking);
  // Constant deceleration, then the speed decays with the time constant of the position control.
  const Vector3d velocity = begin.speed * (leg.to - leg.from).normalized();
  const double stop = begin.distance + stopping_distance(vehicle, velocity);
  const double linear = std::max(0.0, begin.speed / leg.acceleration - gain_time);
  const double t = std::min(braking, linear);
  MotionState state{begin.distance + t * (begin.speed - 0.5 * leg.acceleration * t),
                    begin.speed - t * leg.acceleration, -leg.acceleration};
  if (braking >= recall_time(leg, vehicle, time)) {
    state = {stop, 0.0, 0.0};
  } else if (braking > linear) {
    state.speed *= std::exp((linear - braking) / gain_time);
    state.distance = stop - state.speed * gain_time;
    state.acceleration = -state.speed / gain_time;
  }
  // Above the pad, the descent ends on the ground.
  const double length = (leg.to - leg.from).norm();
  if (leg.is_over_pad && state.distance > length) state = {length, 0.0, 0.0};
  return at(leg, state);
}

ScriptedLeg scripted_leg(const Motion& motion, const Vector3d& from, const Vector3d& to) {
  ScriptedLeg leg{.from = from, .to = to};
  const Vector3d displacement = to - from;
  const double length = displacement.norm();
  if (length == 0.0) return leg;
  const MissionMode& mode = motion.vehicle().mode;
  leg.speed = motion.leg_speed(displacement / length);
  leg.acceleration = motion.leg_acceleration(displacement / length);
  leg.moving = motion.leg_time(displacement) - mode.settle_time;
  return leg;
}

ScriptedLeg landing_leg(const Motion& motion, const Vector3d& from, double end, double foot) {
  ScriptedLeg leg = scripted_leg(motion, from, {from.x(), from.y(), end});
  const double sinking = motion.landing_time(from.z() - foot) - motion.landing_time(end - foot);
  leg.moving = std::max(leg.moving, sinking);
  if (end <= foot) leg.wait = motion.vehicle().mode.touchdown_time;
  return leg;
}

FlightScript make_flight_script(const InterpretedRoute& route, const Motion& motion) {
  return ScriptWriter(route, motion).write();
}

}  // namespace skycap::flight
