#include "missions/online/guided/guided_flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "flight/export/mission_items.h"
#include "flight/route/route.h"
#include "geometry/angle.h"
#include "missions/online/guided/link_watch.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;
using geometry::radians_per_degree;
namespace mavlink = flight::mavlink;

/// MAV_CMD numbers that missions do not have, and ArduCopter's numbers of its modes.
constexpr std::uint16_t set_mode = 176, arm = 400;
constexpr std::uint32_t guided_mode = 4, land_mode = 9;

constexpr double period = 0.1;      ///< of set points [s]
constexpr double rest_speed = 0.2;  ///< [m/s]
constexpr double aim_tolerance = 2.0 * radians_per_degree;
constexpr double settle_patience = 20.0;  ///< for rest and aim, beyond what a leg takes [s]
constexpr double mode_patience = 5.0;     ///< [s]

/// GUID_TIMEOUT: so long ArduCopter flies on with the velocity of its last set point [s].
constexpr double set_point_life = 3.0;
constexpr double reaction = 1.0;  ///< until it has begun to brake [s]

double turn_between(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

std::string place_text(const Vector3d& place) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", place.x(), place.y(), place.z());
}

Trouble refused(std::string what) { return {TroubleKind::refused, std::move(what)}; }

}  // namespace

GuidedFlight::GuidedFlight(mavlink::AutopilotLink& link, FlightFrame frame,
                           const flight::Motion& motion, const GuidedLimits& limits,
                           std::stop_token stop)
    : link_(link),
      frame_(std::move(frame)),
      motion_(motion),
      limits_(limits),
      stop_(std::move(stop)) {}

Vector3d GuidedFlight::position() const { return place_of(link_.state(), frame_); }

geometry::View GuidedFlight::view() const {
  const double yaw = link_.state().yaw().value_or(yaw_);
  const double pitch = link_.state().gimbal_pitch().value_or(pitch_);
  return {position(),
          {std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch), std::sin(pitch)}};
}

MaybeTrouble GuidedFlight::command(std::uint16_t number, const std::array<float, 7>& params,
                                   const std::string& what) {
  const std::optional<std::uint8_t> answer = link_.command(number, params);
  if (answer && *answer == 0) return std::nullopt;
  if (!answer) return Trouble{TroubleKind::link, "no answer when told to " + what};
  const std::string& warning = link_.state().warning();
  return refused(fmt::format("the autopilot refuses to {} (result {}){}", what, *answer,
                             warning.empty() ? "" : ": " + warning));
}

MaybeTrouble GuidedFlight::enter_mode(std::uint32_t mode, const std::string& name) {
  constexpr float by_its_number = 1.0F;
  if (MaybeTrouble trouble =
          command(set_mode, {by_its_number, static_cast<float>(mode)}, "enter mode " + name)) {
    return trouble;
  }
  const double end = link_.now() + mode_patience;
  while (link_.state().heartbeat()->mode != mode) {
    if (link_.now() > end) return refused("the autopilot does not enter mode " + name);
    link_.spin(period);
  }
  mode_ = mode;
  return std::nullopt;
}

MaybeTrouble GuidedFlight::arm_motors() {
  if (MaybeTrouble trouble = command(arm, {1.0F}, "arm")) return trouble;
  const double end = link_.now() + mode_patience;
  while (!link_.state().heartbeat()->is_armed) {
    if (link_.now() > end) return refused("the vehicle does not arm");
    link_.spin(period);
  }
  return std::nullopt;
}

MaybeTrouble GuidedFlight::take_off(const Vector3d& above) {
  if (MaybeTrouble trouble = enter_mode(guided_mode, "GUIDED")) return trouble;
  yaw_ = *link_.state().yaw();
  const Vector3d begin = position();
  const double climb = frame_.to_vehicle(above).height_above_home;
  if (MaybeTrouble trouble = arm_motors()) return trouble;
  if (MaybeTrouble trouble = command(flight::command::takeoff,
                                     {0, 0, 0, 0, 0, 0, static_cast<float>(climb)}, "take off")) {
    return trouble;
  }
  is_flying_ = true;
  place_ = above;
  flown_ = {above};
  const double end = link_.now() + 2.0 * motion_.takeoff_time(climb) + settle_patience;
  while (!is_at(place_)) {
    link_.spin(period);
    MaybeTrouble trouble = watch({begin, place_});
    if (!trouble && link_.now() > end)
      trouble = refused("the vehicle does not climb to its height");
    if (!trouble) continue;
    place_ = position();
    flown_ = {place_};
    return trouble;
  }
  return std::nullopt;
}

MaybeTrouble GuidedFlight::aim(const geometry::View& view) {
  yaw_ = flight::yaw_of(view), pitch_ = flight::pitch_of(view);
  constexpr float by_angles = 2.0F;
  return command(flight::command::mount_control,
                 {static_cast<float>(pitch_ / radians_per_degree), 0, 0, 0, 0, 0, by_angles},
                 "turn the gimbal");
}

MaybeTrouble GuidedFlight::fly(const std::vector<Vector3d>& way) {
  flown_ = {way.front()};
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (MaybeTrouble trouble = fly_leg(way[i])) return trouble;
  }
  return std::nullopt;
}

MaybeTrouble GuidedFlight::fly_leg(const Vector3d& to) {
  const flight::ScriptedLeg leg = flight::scripted_leg(motion_, place_, to);
  const flight::Segment line{leg.from, leg.to};
  double flown = 0.0, last = link_.now();
  const double end = last + leg.moving + settle_patience;
  while (flown < leg.moving || !is_at(to)) {
    send_on(leg, flight::set_point(leg, motion_.vehicle().mode.jerk, flown));
    link_.spin(period);
    MaybeTrouble trouble = watch(line);
    if (!trouble && link_.now() > end) {
      trouble =
          Trouble{TroubleKind::off_leg, "the vehicle does not come to rest at " + place_text(to)};
    }
    if (trouble) {
      if (trouble->kind != TroubleKind::pilot) brake(leg, flown);
      hold_after(*trouble);
      return trouble;
    }
    // However late this program is, the set point does not jump.
    flown += std::min(link_.now() - last, 2.0 * period);
    last = link_.now();
  }
  place_ = to;
  flown_.push_back(to);
  return std::nullopt;
}

/// Who is off his leg holds where he is: no way back to it is proven.
void GuidedFlight::hold_after(const Trouble& trouble) {
  if (trouble.kind == TroubleKind::off_leg) place_ = position();
}

void GuidedFlight::brake(const flight::ScriptedLeg& leg, double time) {
  const double jerk = motion_.vehicle().mode.jerk;
  const double braking = flight::braking_time(leg, jerk, time), begin = link_.now();
  while (link_.now() - begin < braking) {
    send_on(leg, flight::braking_point(leg, jerk, time, link_.now() - begin));
    link_.spin(period);
  }
  place_ = flight::braking_point(leg, jerk, time, braking).position;
  flown_.push_back(place_);
}

MaybeTrouble GuidedFlight::settle(const geometry::View& view) {
  const double end = link_.now() + settle_patience;
  double since = link_.now();
  while (link_.now() - since < limits_.hold) {
    hold_for_a_moment();
    if (MaybeTrouble trouble = watch({place_, place_})) {
      hold_after(*trouble);
      return trouble;
    }
    if (!is_at(place_) || !looks_at(view)) since = link_.now();
    if (link_.now() > end) {
      return refused("the camera does not come to rest at " + place_text(place_) +
                     " to look where it is asked to");
    }
  }
  return std::nullopt;
}

MaybeTrouble GuidedFlight::hold_until(const std::function<bool()>& is_done, double limit,
                                      const Trouble& too_late) {
  const double end = link_.now() + limit;
  while (!is_done()) {
    hold_for_a_moment();
    if (MaybeTrouble trouble = watch({place_, place_})) {
      hold_after(*trouble);
      return trouble;
    }
    if (link_.now() > end) return too_late;
  }
  return std::nullopt;
}

Trouble GuidedFlight::hold_on() {
  is_returning_ = true;
  double heard = link_.now();
  while (true) {
    hold_for_a_moment();
    const MaybeTrouble trouble = watch_link(link_.state(), mode_, link_.now());
    if (!trouble) heard = link_.now();
    if (trouble && trouble->kind == TroubleKind::pilot) return *trouble;
    if (trouble && link_.now() - heard > limits_.patience) return *trouble;
  }
}

void GuidedFlight::hold_for_a_moment() {
  send({place_});
  link_.spin(period);
}

MaybeTrouble GuidedFlight::land(const Vector3d& pad) {
  if (MaybeTrouble trouble = enter_mode(land_mode, "LAND")) return trouble;
  const double end =
      link_.now() + 2.0 * motion_.landing_time(place_.z() - pad.z()) + limits_.patience;
  while (link_.state().heartbeat()->is_armed) {
    link_.spin(period);
    const MaybeTrouble trouble = watch({place_, {place_.x(), place_.y(), pad.z()}});
    if (trouble && link_.state().heartbeat()->is_armed) return trouble;
    if (link_.now() > end) return refused("the vehicle does not land");
  }
  is_flying_ = false;
  return std::nullopt;
}

/// Were it the last set point that arrives, the vehicle would come to rest before the leg's end.
void GuidedFlight::send_on(const flight::ScriptedLeg& leg, flight::SetPoint point) {
  const double left = (leg.to - point.position).norm(), speed = point.velocity.norm();
  if (speed == 0.0) return send(point);
  // Of t v + v^2 / (2 a) = left: it flies on, and brakes.
  constexpr double t = set_point_life + reaction;
  const double most = leg.acceleration * (std::sqrt(t * t + 2.0 * left / leg.acceleration) - t);
  if (speed > most) point.velocity *= most / speed;
  send(point);
}

void GuidedFlight::send(const flight::SetPoint& point) {
  const VehiclePlace place = frame_.to_vehicle(point.position);
  constexpr double wire_degrees = 1e7;
  mavlink::PositionTarget target;
  target.latitude = static_cast<std::int32_t>(std::lround(place.latitude_deg * wire_degrees));
  target.longitude = static_cast<std::int32_t>(std::lround(place.longitude_deg * wire_degrees));
  target.height = static_cast<float>(place.height_above_home);
  target.velocity = {static_cast<float>(point.velocity.y()), static_cast<float>(point.velocity.x()),
                     static_cast<float>(-point.velocity.z())};
  target.yaw = static_cast<float>(yaw_);
  constexpr std::uint16_t accelerations = 64 | 128 | 256, yaw_rate = 2048;
  target.ignored = accelerations | yaw_rate;
  target.frame = flight::frame::relative_int;
  link_.send(target);
}

bool GuidedFlight::is_at(const Vector3d& place) const {
  return (position() - place).norm() <= limits_.arrival &&
         link_.state().position()->velocity.norm() <= rest_speed;
}

bool GuidedFlight::looks_at(const geometry::View& view) const {
  const double yaw = link_.state().yaw().value_or(yaw_);
  const double pitch = link_.state().gimbal_pitch().value_or(pitch_);
  return turn_between(yaw, flight::yaw_of(view)) <= aim_tolerance &&
         std::abs(pitch - flight::pitch_of(view)) <= aim_tolerance;
}

MaybeTrouble GuidedFlight::watch(const flight::Segment& leg) const {
  if (MaybeTrouble trouble = watch_link(link_.state(), mode_, link_.now())) return trouble;
  const double off = std::sqrt(nearest(leg, position()).squared_distance);
  if (off > limits_.corridor) {
    return Trouble{TroubleKind::off_leg,
                   fmt::format("the vehicle is {:.1f} m off its leg, at {}; the leg is proven for "
                               "{:.1f} m",
                               off, place_text(position()), limits_.corridor)};
  }
  if (is_returning_) return std::nullopt;
  if (stop_.stop_requested()) return Trouble{TroubleKind::interrupted, "interrupted"};
  const double battery = this->battery().value_or(0.0);
  if (battery < battery_needed_) {
    return Trouble{TroubleKind::battery,
                   fmt::format("the battery is at {:.0f} %, and the way home needs {:.0f} %",
                               100.0 * battery, 100.0 * battery_needed_)};
  }
  return std::nullopt;
}

}  // namespace skycap::missions::online
