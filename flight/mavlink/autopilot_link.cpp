#include "flight/mavlink/autopilot_link.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight::mavlink {
namespace {

constexpr double beat_period = 1.0;  ///< Period of heartbeats [s].
constexpr std::uint8_t in_progress = 5;
constexpr int max_tries = 5;
/// Timeout per try and receive period [s].
constexpr double answer_patience = 1.0, listening_period = 0.05;

}  // namespace

void AutopilotLink::beat() {
  if (last_beat_ && now() - *last_beat_ < beat_period) return;
  last_beat_ = now();
  constexpr std::uint8_t mav_type_gcs = 6, no_autopilot = 8, is_active = 4;
  Heartbeat heartbeat;
  heartbeat.type = mav_type_gcs;
  heartbeat.autopilot = no_autopilot;
  heartbeat.system_status = is_active;
  send_message(heartbeat);
}

void AutopilotLink::spin(double duration) {
  const double end = now() + duration;
  do {
    beat();
    reader_.feed(port_.receive(std::clamp(end - now(), 0.0, beat_period)));
    while (const std::optional<Frame> frame = reader_.next()) state_.hear(*frame, now());
  } while (now() < end);
}

std::optional<std::uint8_t> AutopilotLink::command(std::uint16_t number,
                                                   const std::array<float, 7>& params) {
  state_.forget_answer(number);
  CommandLong message;
  message.command = number;
  message.params = params;
  message.target = state_.autopilot().value();
  for (int i = 0; i < max_tries; ++i) {
    message.confirmation = static_cast<std::uint8_t>(i);
    send_message(message);
    const double end = now() + answer_patience;
    while (now() < end) {
      spin(listening_period);
      const std::optional<std::uint8_t> answer = state_.answer(number);
      if (answer && *answer != in_progress) return answer;
    }
  }
  return std::nullopt;
}

std::optional<double> AutopilotLink::parameter(const std::string& name) {
  ParameterRequest message;
  message.target = state_.autopilot().value();
  std::copy_n(name.begin(), std::min(name.size(), message.parameter.size()),
              message.parameter.begin());
  for (int i = 0; i < max_tries; ++i) {
    send_message(message);
    const double end = now() + answer_patience;
    while (now() < end) {
      spin(listening_period);
      if (const std::optional<double> value = state_.parameter(name)) return value;
    }
  }
  return std::nullopt;
}

void AutopilotLink::send(PositionTarget target) {
  target.target = state_.autopilot().value();
  constexpr double milliseconds = 1e3;
  target.time_boot_ms = static_cast<std::uint32_t>(std::llround(now() * milliseconds));
  send_message(target);
}

}  // namespace skycap::flight::mavlink
