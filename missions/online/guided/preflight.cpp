#include "missions/online/guided/preflight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

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
struct Wish {
  std::uint32_t id;
  double rate;
};
constexpr std::array<Wish, 5> wishes{{{mavlink::GlobalPosition::id, 10.0},
                                      {mavlink::Attitude::id, 10.0},
                                      {mavlink::GimbalAttitude::id, 5.0},
                                      {mavlink::SystemStatus::id, 1.0},
                                      {mavlink::EstimatorStatus::id, 2.0}}};

/// Processes messages until `is_so` returns true. `late` describes the missing condition.
template <class IsSo, class Late>
MaybeTrouble wait_until(mavlink::AutopilotLink& link, double patience, const std::stop_token& stop,
                        const IsSo& is_so, const Late& late) {
  const double end = link.now() + patience;
  while (!is_so(link.state())) {
    if (stop.stop_requested()) return Trouble{TroubleKind::interrupted, "interrupted"};
    if (link.now() > end) return late(link.state());
    link.spin(listening_period);
  }
  return std::nullopt;
}

MaybeTrouble check_kind(const mavlink::HeardHeartbeat& heard) {
  const bool is_copter = std::ranges::find(multicopters, heard.type) != multicopters.end();
  if (heard.autopilot == ardupilot && is_copter) return std::nullopt;
  return refused(
      fmt::format("unsupported vehicle: the autopilot is number {} and the type {}; only "
                  "ArduCopter is supported (autopilot 3, a multicopter type)",
                  heard.autopilot, heard.type));
}

MaybeTrouble find_vehicle(mavlink::AutopilotLink& link, double patience,
                          const std::stop_token& stop) {
  const auto is_heard = [](const mavlink::VehicleState& state) {
    return state.heartbeat().has_value();
  };
  const auto late = [&](const mavlink::VehicleState&) {
    return Trouble{TroubleKind::link,
                   fmt::format("timeout: no autopilot was heard for {:.0f} s; check that it sends "
                               "MAVLink 2 to the address in --connect",
                               patience)};
  };
  if (MaybeTrouble trouble = wait_until(link, patience, stop, is_heard, late)) return trouble;
  return check_kind(*link.state().heartbeat());
}

MaybeTrouble find_place(mavlink::AutopilotLink& link, double patience,
                        const std::stop_token& stop) {
  const auto is_complete = [](const mavlink::VehicleState& state) {
    return is_sure_of_place(state) && state.position() && state.yaw() && state.battery();
  };
  const auto late = [&](const mavlink::VehicleState& state) {
    const char* missing = !is_sure_of_place(state) ? "its position estimate (EKF_STATUS_REPORT)"
                          : !state.position()      ? "its position (GLOBAL_POSITION_INT)"
                          : !state.yaw()           ? "its heading (ATTITUDE)"
                                                   : "its battery level (SYS_STATUS)";
    return refused(
        fmt::format("timeout: for {:.0f} s the vehicle did not report {}", patience, missing));
  };
  return wait_until(link, patience, stop, is_complete, late);
}

MaybeTrouble check_pad(const mavlink::VehicleState& state, const FlightFrame& frame,
                       const Vector3d& pad, const GuidedLimits& limits) {
  if (state.heartbeat()->is_armed) {
    return refused("the vehicle is armed; a flight begins at the take-off point, disarmed");
  }
  const Vector3d off = place_of(state, frame) - pad;
  const double beside = off.head<2>().norm();
  if (beside <= limits.pad_radius && std::abs(off.z()) <= limits.pad_height) return std::nullopt;
  return refused(
      fmt::format("the vehicle reports a position {:.1f} m beside and {:.1f} m above the take-off "
                  "point ({:.1f}, {:.1f}, {:.1f}); put it there, or correct flight.takeoff or the "
                  "site's latitude and longitude",
                  beside, off.z(), pad.x(), pad.y(), pad.z()));
}

}  // namespace

MaybeTrouble prepare(mavlink::AutopilotLink& link, const FlightFrame& frame, const Vector3d& pad,
                     const GuidedLimits& limits, const std::stop_token& stop) {
  if (MaybeTrouble trouble = find_vehicle(link, limits.patience, stop)) return trouble;
  // An autopilot that rejects the request may still send the message.
  for (const Wish& wish : wishes) {
    constexpr double microseconds = 1e6;
    link.command(set_message_interval,
                 {static_cast<float>(wish.id), static_cast<float>(microseconds / wish.rate)});
  }
  if (MaybeTrouble trouble = find_place(link, limits.patience, stop)) return trouble;
  return check_pad(link.state(), frame, pad, limits);
}

}  // namespace skycap::missions::online
