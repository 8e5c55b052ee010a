#include "missions/online/guided/preflight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "flight/export/mission_items.h"
#include "geometry/angle.h"
#include "missions/online/guided/link_watch.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;
namespace mavlink = flight::mavlink;

constexpr std::uint16_t set_message_interval = 511;                               ///< MAV_CMD
constexpr std::uint8_t ardupilot = 3;                                             ///< MAV_AUTOPILOT
constexpr std::array<std::uint8_t, 8> multicopters{2, 3, 4, 13, 14, 15, 29, 35};  ///< MAV_TYPE
constexpr double listening_period = 0.1;                                          ///< [s]

/// Message and its requested rate [1/s].
struct MessageRequest {
  std::uint32_t id;
  double rate;
};
constexpr std::array<MessageRequest, 5> requests{{{mavlink::GlobalPosition::id, 10.0},
                                                  {mavlink::Attitude::id, 10.0},
                                                  {mavlink::GimbalAttitude::id, 5.0},
                                                  {mavlink::SystemStatus::id, 1.0},
                                                  {mavlink::EstimatorStatus::id, 2.0}}};

/// Processes messages until `is_so` returns true. `late` describes the missing condition.
template <class IsSo, class Late>
MaybeFailure wait_until(mavlink::AutopilotLink& link, double patience, const std::stop_token& stop,
                        const IsSo& is_so, const Late& late) {
  const double end = link.now() + patience;
  while (!is_so(link.state())) {
    if (stop.stop_requested()) return FlightFailure{FailureKind::interrupted, "interrupted"};
    if (link.now() > end) return late(link.state());
    link.spin(listening_period);
  }
  return std::nullopt;
}

MaybeFailure check_kind(const mavlink::HeardHeartbeat& heard) {
  const bool is_copter = std::ranges::find(multicopters, heard.type) != multicopters.end();
  if (heard.autopilot == ardupilot && is_copter) return std::nullopt;
  return rejected(
      fmt::format("unsupported vehicle: MAV_AUTOPILOT {}, MAV_TYPE {}; only ArduCopter is "
                  "supported (MAV_AUTOPILOT 3 and a multicopter type)",
                  heard.autopilot, heard.type));
}

MaybeFailure find_vehicle(mavlink::AutopilotLink& link, double patience,
                          const std::stop_token& stop) {
  const auto is_heard = [](const mavlink::VehicleState& state) {
    return state.heartbeat().has_value();
  };
  const auto late = [&](const mavlink::VehicleState&) {
    return FlightFailure{
        FailureKind::link,
        fmt::format("timeout: no message from an autopilot for {:.0f} s; check that it "
                    "sends MAVLink 2 to the address in --connect",
                    patience)};
  };
  if (MaybeFailure failure = wait_until(link, patience, stop, is_heard, late)) return failure;
  return check_kind(*link.state().heartbeat());
}

MaybeFailure wait_for_position(mavlink::AutopilotLink& link, double patience,
                               const std::stop_token& stop) {
  const auto is_complete = [](const mavlink::VehicleState& state) {
    return has_position_estimate(state) && state.position() && state.yaw() && state.battery();
  };
  const auto late = [&](const mavlink::VehicleState& state) {
    const char* missing = !has_position_estimate(state)
                              ? "its position estimate (EKF_STATUS_REPORT)"
                          : !state.position() ? "its position (GLOBAL_POSITION_INT)"
                          : !state.yaw()      ? "its heading (ATTITUDE)"
                                              : "its battery level (SYS_STATUS)";
    return rejected(
        fmt::format("timeout: the vehicle did not report {1} for {0:.0f} s", patience, missing));
  };
  return wait_until(link, patience, stop, is_complete, late);
}

MaybeFailure check_pad(const mavlink::VehicleState& state, const FlightFrame& frame,
                       const Vector3d& pad, const GuidedLimits& limits) {
  if (state.heartbeat()->is_armed) {
    return rejected(
        "the vehicle is armed; a flight must begin at the take-off point, with the vehicle "
        "disarmed");
  }
  const Vector3d off = to_position(state, frame) - pad;
  const double horizontal = off.head<2>().norm();
  if (horizontal <= limits.pad_radius && std::abs(off.z()) <= limits.pad_height)
    return std::nullopt;
  return rejected(
      fmt::format("the vehicle reports a position that is {:.1f} m horizontally and {:.1f} m "
                  "vertically from the take-off point ({:.1f}, {:.1f}, {:.1f}); move the vehicle "
                  "there, or correct flight.takeoff or the site's latitude and longitude",
                  horizontal, off.z(), pad.x(), pad.y(), pad.z()));
}

/// Setpoints come ten a second: a vehicle that stops after less than half a second without one
/// would stop all the time; one that flies on for long leaves its leg when the link fails.
MaybeFailure check_timeout(mavlink::AutopilotLink& link) {
  constexpr double shortest = 0.5, longest = 5.0;  // [s]
  const std::optional<double> timeout = link.parameter("GUID_TIMEOUT");
  if (!timeout || (*timeout >= shortest && *timeout <= longest)) return std::nullopt;
  return rejected(
      fmt::format("parameter GUID_TIMEOUT must be from {:g} to {:g} s, but is {:g} s; set it to 3 "
                  "and repeat the command",
                  shortest, longest, *timeout));
}

/// Turns the gimbal to the horizon, or as near to it as it can.
MaybeFailure check_gimbal(mavlink::AutopilotLink& link, const flight::Vehicle& vehicle) {
  if (vehicle.gimbal_min == vehicle.gimbal_max) return std::nullopt;  // a fixed camera
  const char* remedy =
      "configure the gimbal (MNT1_TYPE, and SERVOn_FUNCTION 6 to 8 of a servo gimbal), or describe "
      "a fixed camera in the vehicle file with equal gimbal_min_deg and gimbal_max_deg";
  if (const std::optional<double> type = link.parameter("MNT1_TYPE"); type && *type == 0.0) {
    return rejected(std::string("the autopilot has no gimbal: parameter MNT1_TYPE is 0; ") +
                    remedy);
  }
  constexpr float by_angles = 2.0F;
  const double pitch = std::clamp(0.0, vehicle.gimbal_min, vehicle.gimbal_max);
  const std::optional<std::uint8_t> answer = link.command(
      flight::command::mount_control,
      {static_cast<float>(pitch / geometry::radians_per_degree), 0, 0, 0, 0, 0, by_angles});
  if (answer && *answer == 0) return std::nullopt;
  const std::string how = answer ? fmt::format("rejected the command (result {})", *answer)
                                 : std::string("did not answer the command");
  return rejected("the autopilot " + how + " to turn the gimbal; " + remedy);
}

}  // namespace

MaybeFailure prepare(mavlink::AutopilotLink& link, const FlightFrame& frame, const Vector3d& pad,
                     const flight::Vehicle& vehicle, const GuidedLimits& limits,
                     const std::stop_token& stop) {
  if (MaybeFailure failure = find_vehicle(link, limits.patience, stop)) return failure;
  // An autopilot that rejects the request may still send the message.
  for (const MessageRequest& request : requests) {
    constexpr double microseconds = 1e6;
    link.command(set_message_interval,
                 {static_cast<float>(request.id), static_cast<float>(microseconds / request.rate)});
  }
  if (MaybeFailure failure = wait_for_position(link, limits.patience, stop)) return failure;
  if (MaybeFailure failure = check_pad(link.state(), frame, pad, limits)) return failure;
  if (MaybeFailure failure = check_timeout(link)) return failure;
  return check_gimbal(link, vehicle);
}

}  // namespace skycap::missions::online
