#include "missions/online/guided/guided_flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "flight/export/mission_items.h"
#include "flight/route/route.h"
#include "geometry/angle.h"
#include "missions/online/guided/aim_errors.h"
#include "missions/online/guided/leg_set_points.h"
#include "missions/online/guided/link_watch.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;
using geometry::radians_per_degree;
namespace mavlink = flight::mavlink;

/// MAV_CMD numbers that mission files do not use, and ArduCopter's mode numbers.
constexpr std::uint16_t set_mode = 176, arm = 400;
constexpr std::uint32_t guided_mode = 4, land_mode = 9;

constexpr double period = 0.1;  ///< Interval between setpoints [s].
/// Time limit for coming to rest and aiming, in addition to the leg time [s].
constexpr double settle_patience = 20.0;
constexpr double mode_patience = 5.0;  ///< [s]

/// Maximum delay between two setpoints before the vehicle is stopped [s]. Up to this delay, the
/// vehicle has flown as far as the missing setpoints would have led it.
constexpr double longest_stall = 1.0;

double turn_between(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

std::string position_text(const Vector3d& location) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", location.x(), location.y(), location.z());
}

/// Combines a trouble with one that occurred while the vehicle came to rest. The later one
/// determines the further actions.
FlightFailure joined(const FlightFailure& first, const MaybeFailure& later) {
  if (!later) return first;
  return {later->kind, first.what + "; then " + later->what};
}

}  // namespace

GuidedFlight::GuidedFlight(mavlink::AutopilotLink& link, FlightFrame frame,
                           const flight::Motion& motion, const GuidedLimits& limits,
                           std::stop_token stop)
    : link_(link),
      frame_(std::move(frame)),
      motion_(motion),
      limits_(limits),
      stop_(std::move(stop)) {}

void GuidedFlight::listen() {
  link_.spin(period);
  const mavlink::VehicleState& state = link_.state();
  if (state.gimbal_pitch() && state.pitch()) {
    gimbal_.hear(link_.now(), *state.gimbal_pitch(), *state.pitch());
  }
  if (state.position()) observer_.track(view(), battery());
}

double GuidedFlight::camera_pitch() const {
  const mavlink::VehicleState& state = link_.state();
  if (has_fixed_camera()) return pitch_ + state.pitch().value_or(0.0);
  if (!state.gimbal_pitch()) return pitch_;
  return gimbal_.camera_pitch(*state.gimbal_pitch(), state.pitch().value_or(0.0));
}

/// Whether the camera is fixed to the airframe: the vehicle turns it, nothing tilts it.
bool GuidedFlight::has_fixed_camera() const {
  return motion_.vehicle().gimbal_min == motion_.vehicle().gimbal_max;
}

Vector3d GuidedFlight::position() const { return to_position(link_.state(), frame_); }

geometry::View GuidedFlight::view() const {
  const double yaw = link_.state().yaw().value_or(yaw_);
  const double pitch = camera_pitch();
  return {position(),
          {std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch), std::sin(pitch)}};
}

MaybeFailure GuidedFlight::command(std::uint16_t number, const std::array<float, 7>& params,
                                   const std::string& what) {
  const std::optional<std::uint8_t> answer = link_.command(number, params);
  if (answer && *answer == 0) return std::nullopt;
  if (!answer)
    return FlightFailure{FailureKind::link, "timeout: no answer to the command to " + what};
  const std::string& warning = link_.state().warning();
  return rejected(fmt::format("the autopilot rejected the command to {} (result {}){}", what,
                              *answer, warning.empty() ? "" : ": " + warning));
}

MaybeFailure GuidedFlight::enter_mode(std::uint32_t mode, const std::string& name) {
  constexpr float by_its_number = 1.0F;
  if (MaybeFailure failure =
          command(set_mode, {by_its_number, static_cast<float>(mode)}, "enter mode " + name)) {
    return failure;
  }
  const double end = link_.now() + mode_patience;
  while (link_.state().heartbeat()->mode != mode) {
    if (link_.now() > end) return rejected("timeout: the autopilot did not enter mode " + name);
    listen();
  }
  mode_ = mode;
  return std::nullopt;
}

MaybeFailure GuidedFlight::arm_motors() {
  if (MaybeFailure failure = command(arm, {1.0F}, "arm")) return failure;
  const double end = link_.now() + mode_patience;
  while (!link_.state().heartbeat()->is_armed) {
    if (link_.now() > end) return rejected("timeout: the vehicle did not arm");
    listen();
  }
  return std::nullopt;
}

MaybeFailure GuidedFlight::take_off(const Vector3d& above) {
  if (MaybeFailure failure = enter_mode(guided_mode, "GUIDED")) return failure;
  yaw_ = *link_.state().yaw();
  const Vector3d begin = position();
  const double climb = frame_.to_vehicle(above).height_above_home;
  if (MaybeFailure failure = arm_motors()) return failure;
  if (MaybeFailure failure = command(flight::command::takeoff,
                                     {0, 0, 0, 0, 0, 0, static_cast<float>(climb)}, "take off")) {
    return failure;
  }
  is_flying_ = true;
  position_ = above;
  executed_path_ = {above};
  const double end = link_.now() + 2.0 * motion_.takeoff_time(climb) + settle_patience;
  while (!is_at(position_)) {
    listen();
    MaybeFailure failure = watch({begin, position_});
    if (!failure && link_.now() > end)
      failure = rejected("timeout: the vehicle did not climb to its take-off altitude");
    if (!failure) continue;
    position_ = stopping_point({begin, above});
    executed_path_ = {position_};
    if (failure->kind == FailureKind::pilot) return failure;
    return joined(*failure, come_to_rest({begin, above}));
  }
  return std::nullopt;
}

MaybeFailure GuidedFlight::aim(const geometry::View& view) {
  yaw_ = flight::compute_yaw(view), pitch_ = flight::compute_pitch(view);
  if (has_fixed_camera()) {
    pitch_ = motion_.vehicle().gimbal_min;
    return std::nullopt;
  }
  gimbal_.begin_aim(link_.now(), pitch_);
  constexpr float by_angles = 2.0F;
  return command(flight::command::mount_control,
                 {static_cast<float>(pitch_ / radians_per_degree), 0, 0, 0, 0, 0, by_angles},
                 "turn the gimbal");
}

MaybeFailure GuidedFlight::fly(const std::vector<Vector3d>& path) {
  executed_path_ = {path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    do {
      if (MaybeFailure failure = hold_on_request()) return failure;
      if (MaybeFailure failure = fly_leg(path[i])) return failure;
    } while (position_ != path[i]);  // held on the leg
  }
  return std::nullopt;
}

/// Flies to the end of a leg. On a hold request, the vehicle stops on the leg.
MaybeFailure GuidedFlight::fly_leg(const Vector3d& to) {
  const flight::ScriptedLeg leg = flight::scripted_leg(motion_, position_, to);
  leg_ = {leg.from, leg.to};
  double elapsed = 0.0, last = link_.now();
  const double end = last + leg.moving + settle_patience;
  while (elapsed < leg.moving || !is_at(to)) {
    const flight::SetPoint sent =
        send_on(leg, flight::set_point(leg, motion_.vehicle().mode.jerk, elapsed));
    listen();
    const double late = link_.now() - last;
    MaybeFailure failure;
    if (late > longest_stall) {
      listen();  // Processes messages received during the stall.
      failure =
          FlightFailure{FailureKind::stalled,
                        fmt::format("setpoints were interrupted for {:.1f} s because this program "
                                    "was suspended; stopping at the current position",
                                    late)};
    } else {
      failure = watch(leg_);
    }
    if (!failure && link_.now() > end) {
      failure = FlightFailure{FailureKind::off_leg,
                              "timeout: the vehicle did not come to rest at " + position_text(to)};
    }
    elapsed = time_after(leg, motion_.vehicle().mode.jerk, elapsed, sent, late);
    if (failure) return abort_leg(leg, elapsed, *failure);
    if (must_hold()) {
      brake(leg, elapsed);
      return come_to_rest(leg_);
    }
    last = link_.now();
  }
  position_ = to;
  executed_path_.push_back(to);
  return std::nullopt;
}

/// Stops on the leg and holds position. Returns the trouble, combined with any later one.
FlightFailure GuidedFlight::abort_leg(const flight::ScriptedLeg& leg, double time,
                                      const FlightFailure& failure) {
  if (failure.kind == FailureKind::pilot) return failure;
  if (failure.kind == FailureKind::stalled) {
    if (MaybeFailure silent = watch_link(link_.state(), mode_, link_.now())) {
      brake(leg, time);
      return joined(failure, silent);
    }
    position_ = stopping_point(leg_);
    executed_path_.push_back(position_);
  } else {
    brake(leg, time);
  }
  const bool is_heard = failure.kind != FailureKind::link && failure.kind != FailureKind::position;
  // A vehicle off its leg holds its position, because no path back to the leg is verified.
  hold_after(failure);
  if (!is_heard || failure.kind == FailureKind::off_leg) return failure;
  return joined(failure, come_to_rest(leg_));
}

void GuidedFlight::hold_after(const FlightFailure& failure) {
  if (failure.kind == FailureKind::off_leg) position_ = position();
}

void GuidedFlight::brake(const flight::ScriptedLeg& leg, double time) {
  const double jerk = motion_.vehicle().mode.jerk;
  const double braking = flight::braking_time(leg, jerk, time), begin = link_.now();
  while (link_.now() - begin < braking) {
    send_on(leg, flight::braking_point(leg, jerk, time, link_.now() - begin));
    listen();
  }
  position_ = flight::braking_point(leg, jerk, time, braking).position;
  executed_path_.push_back(position_);
}

/// Holds until the vehicle is at rest at the hold position, on the given leg.
MaybeFailure GuidedFlight::come_to_rest(const flight::Segment& leg) {
  const double end = link_.now() + settle_patience;
  while (!is_at(position_)) {
    hold_briefly();
    MaybeFailure failure = watch_position(leg);
    if (!failure && link_.now() > end) {
      failure =
          FlightFailure{FailureKind::off_leg,
                        "timeout: the vehicle did not come to rest at " + position_text(position_)};
    }
    if (!failure) continue;
    hold_after(*failure);
    return failure;
  }
  return std::nullopt;
}

MaybeFailure GuidedFlight::settle(const geometry::View& view) {
  const double end = link_.now() + settle_patience;
  double since = link_.now();
  while (link_.now() - since < limits_.hold) {
    hold_briefly();
    if (MaybeFailure failure = watch({position_, position_})) {
      hold_after(*failure);
      return failure;
    }
    const std::string failures = describe_failures(errors_at(view), limits_.arrival);
    if (!failures.empty()) since = link_.now();
    if (link_.now() > end) {
      return rejected(
          "timeout: the camera did not settle at " + position_text(position_) +
          " in the requested direction: " +
          (failures.empty() ? "the pose was not held for the time flight.hold" : failures));
    }
  }
  return std::nullopt;
}

MaybeFailure GuidedFlight::hold_until(const std::function<bool()>& is_done, double limit,
                                      const FlightFailure& too_late) {
  const double end = link_.now() + limit;
  while (!is_done()) {
    hold_briefly();
    if (MaybeFailure failure = watch({position_, position_})) {
      hold_after(*failure);
      return failure;
    }
    if (link_.now() > end) return too_late;
  }
  return std::nullopt;
}

MaybeFailure GuidedFlight::hold_on_request() {
  if (!must_hold()) return std::nullopt;
  observer_.note("holding position on request");
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  MaybeFailure failure = hold_until([this] { return !must_hold(); }, unlimited, rejected(""));
  if (!failure) observer_.note("hold released");
  return failure;
}

FlightFailure GuidedFlight::hold_until_takeover() {
  is_returning_ = true;
  double heard = link_.now();
  bool is_lost = false;
  while (true) {
    hold_briefly();
    const MaybeFailure failure = watch_link(link_.state(), mode_, link_.now());
    if (!failure) heard = link_.now();
    // When the link is restored, the vehicle holds at the position reached in the meantime.
    if (!failure && is_lost) position_ = stopping_point(leg_);
    is_lost = failure && failure->kind == FailureKind::link;
    if (failure && failure->kind == FailureKind::pilot) return *failure;
    if (failure && link_.now() - heard > limits_.patience) return *failure;
  }
}

void GuidedFlight::hold_briefly() {
  send({position_});
  listen();
}

MaybeFailure GuidedFlight::land(const Vector3d& pad) {
  if (MaybeFailure failure = enter_mode(land_mode, "LAND")) return failure;
  const double end =
      link_.now() + 2.0 * motion_.landing_time(position_.z() - pad.z()) + limits_.patience;
  while (link_.state().heartbeat()->is_armed) {
    listen();
    const MaybeFailure failure = watch({position_, {position_.x(), position_.y(), pad.z()}});
    if (failure && link_.state().heartbeat()->is_armed) return failure;
    if (link_.now() > end) return rejected("timeout: the vehicle did not land");
  }
  is_flying_ = false;
  return std::nullopt;
}

/// Sends a setpoint from which the vehicle would stop before the end of the leg without further
/// messages.
flight::SetPoint GuidedFlight::send_on(const flight::ScriptedLeg& leg,
                                       const flight::SetPoint& point) {
  const flight::SetPoint sent = with_stopping_speed(leg, point);
  send(sent);
  return sent;
}

Vector3d GuidedFlight::stopping_point(const flight::Segment& leg) const {
  const Vector3d path = leg.to - leg.from;
  const double acceleration = path.norm() == 0.0 ? motion_.vehicle().mode.acceleration
                                                 : motion_.leg_acceleration(path.normalized());
  return online::stopping_point(leg, position(), link_.state().position()->velocity, acceleration);
}

void GuidedFlight::send(const flight::SetPoint& point) {
  const VehiclePosition location = frame_.to_vehicle(point.position);
  constexpr double wire_degrees = 1e7;
  mavlink::PositionTarget target;
  target.latitude = static_cast<std::int32_t>(std::lround(location.latitude_deg * wire_degrees));
  target.longitude = static_cast<std::int32_t>(std::lround(location.longitude_deg * wire_degrees));
  target.height = static_cast<float>(location.height_above_home);
  target.velocity = {static_cast<float>(point.velocity.y()), static_cast<float>(point.velocity.x()),
                     static_cast<float>(-point.velocity.z())};
  target.yaw = static_cast<float>(yaw_);
  constexpr std::uint16_t accelerations = 64 | 128 | 256, yaw_rate = 2048;
  target.ignored = accelerations | yaw_rate;
  target.frame = flight::frame::relative_int;
  link_.send(target);
}

bool GuidedFlight::is_at(const Vector3d& location) const {
  return (position() - location).norm() <= limits_.arrival &&
         link_.state().position()->velocity.norm() <= rest_speed;
}

AimErrors GuidedFlight::errors_at(const geometry::View& view) const {
  return {.position = (position() - position_).norm(),
          .speed = link_.state().position()->velocity.norm(),
          .turn = turn_between(link_.state().yaw().value_or(yaw_), flight::compute_yaw(view)),
          .pitch = camera_pitch(),
          // A fixed camera tilts with the vehicle, which its pose tells.
          .asked_pitch = has_fixed_camera() ? camera_pitch() : flight::compute_pitch(view),
          .vehicle_pitch = link_.state().pitch().value_or(0.0)};
}

/// Returns a trouble if the position or the control of the vehicle is uncertain.
MaybeFailure GuidedFlight::watch_position(const flight::Segment& leg) const {
  if (MaybeFailure failure = watch_link(link_.state(), mode_, link_.now())) return failure;
  const double off = std::sqrt(nearest(leg, position()).squared_distance);
  if (off > limits_.corridor) {
    return FlightFailure{
        FailureKind::off_leg,
        fmt::format("cross-track error of {:.1f} m at {}; the leg is verified for {:.1f} m", off,
                    position_text(position()), limits_.corridor)};
  }
  return std::nullopt;
}

MaybeFailure GuidedFlight::watch(const flight::Segment& leg) const {
  if (MaybeFailure failure = watch_position(leg)) return failure;
  if (is_returning_) return std::nullopt;
  if (stop_.stop_requested()) return FlightFailure{FailureKind::interrupted, "interrupted"};
  const double battery = this->battery().value_or(0.0);
  if (battery < battery_needed_) {
    return FlightFailure{FailureKind::battery,
                         fmt::format("battery at {:.0f}%; the return requires {:.0f}%",
                                     100.0 * battery, 100.0 * battery_needed_)};
  }
  return std::nullopt;
}

}  // namespace skycap::missions::online
