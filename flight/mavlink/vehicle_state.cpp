#include "flight/mavlink/vehicle_state.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace skycap::flight::mavlink {
namespace {

/// Frames up to this number behind the last one are late. A larger difference indicates a restart
/// of the sender.
constexpr int late_frames = 64;

constexpr std::uint8_t no_autopilot = 8, armed_flag = 128, warning_severity = 4;

/// Returns the pitch of a gimbal's optical axis, or std::nullopt for an invalid rotation.
std::optional<double> compute_pitch(const std::array<float, 4>& turn) {
  double norm = 0.0;
  for (const float part : turn) norm += static_cast<double>(part) * part;
  if (!(norm > 0.9 && norm < 1.1)) return std::nullopt;  // Also rejects NaN.
  const double w = turn[0], x = turn[1], y = turn[2], z = turn[3];
  return std::asin(std::clamp(2.0 * (w * y - z * x) / norm, -1.0, 1.0));
}

template <std::size_t N>
std::string to_string(const std::array<char, N>& letters) {
  std::string text;
  for (const char letter : letters) {
    if (letter == '\0') break;
    text += letter >= ' ' && letter <= '~' ? letter : '?';
  }
  return text;
}

}  // namespace

bool VehicleState::is_new(const Frame& frame) {
  const auto [known, is_first] = sequences_.try_emplace(frame.sender.component, frame.sequence);
  if (is_first) return true;
  const auto gap = static_cast<std::uint8_t>(known->second - frame.sequence);
  if (gap < late_frames) return false;
  known->second = frame.sequence;
  return true;
}

std::optional<std::uint8_t> VehicleState::answer(std::uint16_t command) const {
  const auto found = answers_.find(command);
  return found == answers_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<double> VehicleState::parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? std::nullopt : std::optional(found->second);
}

void VehicleState::hear(const Frame& frame, double now) {
  if (!autopilot_) {
    const auto heartbeat = decode<Heartbeat>(frame);
    if (!heartbeat || heartbeat->autopilot == no_autopilot) return;
    autopilot_ = frame.sender;
  }
  if (frame.sender.system != autopilot_->system || !is_new(frame)) return;
  last_heard_ = now;
  // Gimbals may be separate components.
  if (const auto gimbal = decode<GimbalAttitude>(frame)) {
    if (const auto pitch = compute_pitch(gimbal->turn)) pitch_ = pitch;
  } else if (frame.sender.component == autopilot_->component) {
    hear_autopilot(frame, now);
  }
}

void VehicleState::hear_autopilot(const Frame& frame, double now) {
  if (const auto heartbeat = decode<Heartbeat>(frame)) {
    heartbeat_ = {now, heartbeat->autopilot, heartbeat->type, heartbeat->custom_mode,
                  (heartbeat->base_mode & armed_flag) != 0};
  } else if (const auto position = decode<GlobalPosition>(frame)) {
    hear_position(*position, now);
  } else if (const auto attitude = decode<Attitude>(frame)) {
    if (std::isfinite(attitude->yaw)) yaw_ = attitude->yaw;
    if (std::isfinite(attitude->pitch)) body_pitch_ = attitude->pitch;
  } else if (const auto status = decode<SystemStatus>(frame)) {
    const int percent = status->battery_remaining;
    battery_ = percent >= 0 && percent <= 100 ? std::optional(0.01 * percent) : std::nullopt;
  } else if (const auto estimator = decode<EstimatorStatus>(frame)) {
    estimator_ = estimator->flags;
  } else if (const auto answer = decode<CommandAnswer>(frame)) {
    answers_[answer->command] = answer->result;
  } else if (const auto parameter = decode<ParameterValue>(frame)) {
    constexpr std::size_t most_parameters = 4096;
    if (std::isfinite(parameter->value) && parameters_.size() < most_parameters) {
      parameters_[to_string(parameter->parameter)] = parameter->value;
    }
  } else if (const auto text = decode<StatusText>(frame)) {
    if (text->severity <= warning_severity) warning_ = to_string(text->text);
  }
}

void VehicleState::hear_position(const GlobalPosition& message, double now) {
  constexpr std::int32_t max_latitude = 900'000'000, max_longitude = 1'800'000'000;
  if (std::abs(static_cast<double>(message.latitude)) > max_latitude ||
      std::abs(static_cast<double>(message.longitude)) > max_longitude) {
    return;
  }
  // A position with an unchanged timestamp is ignored.
  if (position_ && message.time_boot_ms == position_->boot_ms) return;
  constexpr double degrees = 1e-7, metres = 1e-3, metres_a_second = 1e-2;
  position_ = {now,
               message.time_boot_ms,
               degrees * message.latitude,
               degrees * message.longitude,
               metres * message.height_above_home,
               metres_a_second *
                   Eigen::Vector3d(message.east_speed, message.north_speed, -message.down_speed)};
}

}  // namespace skycap::flight::mavlink
