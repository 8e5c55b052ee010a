#include "missions/online/guided/link_watch.h"

#include <algorithm>

#include <fmt/format.h>

namespace skycap::missions::online {
namespace {

namespace mavlink = flight::mavlink;

/// EKF_STATUS_FLAGS: attitude, velocity, absolute position and height must be valid. Flags of an
/// uncertain estimate must not be set.
constexpr std::uint16_t estimates_needed = 1 | 2 | 4 | 16 | 32, prediction_flags = 128 | 1024;

constexpr double heartbeat_patience = 5.0;  ///< Heartbeats are sent at 1 Hz.
constexpr double position_patience = 1.5;   ///< Positions are sent at 10 Hz.
constexpr double silence_patience = 0.75;   ///< At least one message arrives with each position.

}  // namespace

bool has_position_estimate(const mavlink::VehicleState& state) {
  return state.estimator() && (*state.estimator() & estimates_needed) == estimates_needed &&
         (*state.estimator() & prediction_flags) == 0;
}

Eigen::Vector3d to_position(const mavlink::VehicleState& state, const FlightFrame& frame) {
  const mavlink::HeardPosition& heard = state.position().value();
  return frame.to_mission({heard.latitude_deg, heard.longitude_deg, heard.height_above_home});
}

MaybeFailure watch_link(const mavlink::VehicleState& state, std::uint32_t mode, double now) {
  const mavlink::HeardHeartbeat& heartbeat = state.heartbeat().value();
  if (!heartbeat.is_armed) return FlightFailure{FailureKind::pilot, "the vehicle was disarmed"};
  if (heartbeat.mode != mode) {
    return FlightFailure{
        FailureKind::pilot,
        fmt::format("another station or the pilot has control: the vehicle is in mode "
                    "{}, which was not set by this program",
                    heartbeat.mode)};
  }
  const double silence = now - state.last_heard().value();
  const double without_beat = now - heartbeat.time;
  const double age = now - state.position().value().time;
  // Other messages shortly after the last position do not shorten the silence.
  const bool is_silent = age > position_patience && silence > silence_patience;
  if (is_silent || without_beat > heartbeat_patience) {
    return FlightFailure{FailureKind::link,
                         fmt::format("link lost: no message from the vehicle for {:.1f} s",
                                     std::max(silence, without_beat))};
  }
  if (age > position_patience) {
    return FlightFailure{FailureKind::position,
                         fmt::format("the position estimate is {:.1f} s old", age)};
  }
  if (has_position_estimate(state)) return std::nullopt;
  return FlightFailure{FailureKind::position, "position estimate lost (EKF)"};
}

}  // namespace skycap::missions::online
