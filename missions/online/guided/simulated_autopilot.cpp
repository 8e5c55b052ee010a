#include "missions/online/guided/simulated_autopilot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "flight/export/mission_items.h"
#include "geometry/angle.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;
using flight::mavlink::Bytes;
namespace mavlink = flight::mavlink;

constexpr double step_time = 0.04, words_period = 0.1;  ///< [s]
constexpr double guided_timeout = 3.0;                  ///< GUID_TIMEOUT
constexpr std::uint32_t guided = 4, loiter = 5, landing = 9;
constexpr mavlink::Address itself{1, 1};

/// Returns the correction velocity for a position error: proportional for small errors, otherwise
/// limited so that `limit` is sufficient for braking (AP_Math/control.cpp, sqrt_controller).
Vector3d square_root_controller(const Vector3d& error, double gain, double limit) {
  const double size = error.norm(), linear = limit / (gain * gain);
  if (size <= linear) return gain * error;
  return std::sqrt(2.0 * limit * (size - 0.5 * linear)) / size * error;
}

Vector3d bounded(const Vector3d& value, double max) {
  const double size = value.norm();
  return size > max ? Vector3d(max / size * value) : value;
}

double turned(double from, double to, double max) {
  return from + std::clamp(std::remainder(to - from, 2.0 * std::numbers::pi), -max, max);
}

/// Stepped port with its own autopilot. A simulated pilot takes control of a vehicle that has not
/// moved for two minutes, because `fly` otherwise holds the position without end after a failure.
class SimulatedPort : public mavlink::Port {
 public:
  SimulatedPort(const flight::FlightOptions& flight, const Vector3d& pad)
      : autopilot_(flight, pad, {}), last_position_(pad) {}

  void send(std::span<const std::uint8_t> bytes) override { port_.send(bytes); }
  Bytes receive(double patience) override {
    constexpr double movement = 0.3, pilots_patience = 120.0;  // [m], [s]
    if ((autopilot_.position() - last_position_).norm() > movement) {
      last_position_ = autopilot_.position();
      last_movement_ = now();
    }
    if (now() - last_movement_ > pilots_patience) autopilot_.take_over();
    return port_.receive(patience);
  }
  double now() const override { return port_.now(); }

 private:
  SimulatedAutopilot autopilot_;
  Vector3d last_position_;
  double last_movement_ = 0.0;
  SteppedPort port_{autopilot_};
};

}  // namespace

SimulatedAutopilot::SimulatedAutopilot(const flight::FlightOptions& flight, const Vector3d& pad,
                                       const AutopilotFaults& faults)
    : faults_(faults),
      frame_(flight.site.origin, pad),
      motion_(flight.required_vehicle(), flight.route(pad).conditions),
      vehicle_(motion_, pad + faults.pad_offset),
      pad_(pad + faults.pad_offset),
      is_armed_(faults.is_armed) {}

void SimulatedAutopilot::take_over() { mode_ = loiter; }

bool SimulatedAutopilot::is_past(const std::optional<double>& moment) const {
  return moment && taken_off_ && time_ - *taken_off_ >= *moment;
}

void SimulatedAutopilot::hear(std::span<const std::uint8_t> bytes) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  if (is_past(faults_.silent) || share(random_) < faults_.lost) return;
  reader_.feed(bytes);
  while (const auto frame = reader_.next()) {
    if (const auto command = mavlink::decode<mavlink::CommandLong>(*frame)) obey(*command);
    if (const auto target = mavlink::decode<mavlink::PositionTarget>(*frame)) aim_at(*target);
    if (const auto request = mavlink::decode<mavlink::ParameterRequest>(*frame)) tell(*request);
  }
}

void SimulatedAutopilot::obey(const mavlink::CommandLong& command) {
  constexpr std::uint16_t set_mode = 176, arm = 400;
  bool is_accepted = true;
  if (command.command == set_mode) {
    mode_ = static_cast<std::uint32_t>(command.params[1]);
  } else if (command.command == arm) {
    is_accepted = !faults_.rejects_arming;
    is_armed_ = is_armed_ || is_accepted;
    mavlink::StatusText text;
    text.severity = 2;
    const std::string reason = "PreArm: Compass not calibrated";
    std::ranges::copy(reason, text.text.begin());
    if (!is_accepted) send_frame(text);
  } else if (command.command == flight::command::takeoff) {
    is_accepted = is_armed_ && mode_ == guided;
    if (is_accepted && !taken_off_) {
      taken_off_ = time_;
      climb_ = flight::scripted_leg(motion_, pad_, pad_ + Vector3d(0, 0, command.params[6]));
      target_ = {climb_->to};
    }
  } else if (command.command == flight::command::mount_control) {
    is_accepted = !faults_.has_no_gimbal;
    if (is_accepted) target_pitch_ = command.params[0] * geometry::radians_per_degree;
  }
  mavlink::CommandAnswer answer;
  answer.command = command.command;
  answer.result = is_accepted ? 0 : 4;
  send_frame(answer);
}

void SimulatedAutopilot::tell(const mavlink::ParameterRequest& request) {
  const std::string name(request.parameter.data(), request.parameter.size());
  mavlink::ParameterValue answer;
  answer.parameter = request.parameter;
  if (name.starts_with("MNT1_TYPE")) {
    answer.value = faults_.has_no_gimbal ? 0.0F : 1.0F;
  } else if (name.starts_with("GUID_TIMEOUT")) {
    answer.value = faults_.guided_timeout;
  } else {
    return;
  }
  if (faults_.answers_parameters) send_frame(answer);
}

void SimulatedAutopilot::aim_at(const mavlink::PositionTarget& target) {
  const Vector3d vehicle_position =
      frame_.to_mission({1e-7 * target.latitude, 1e-7 * target.longitude, target.height});
  set_points_.push_back(vehicle_position);
  if (mode_ != guided || !is_armed_) return;
  climb_.reset();
  target_ = {vehicle_position, {target.velocity[1], target.velocity[0], -target.velocity[2]}};
  target_time_ = time_;
  target_yaw_ = target.yaw;
}

flight::SetPoint SimulatedAutopilot::target_point() {
  if (mode_ == landing) {
    flight::SetPoint down{vehicle_.position(), {0, 0, -motion_.vehicle().mode.landing_speed}};
    down.position.head<2>() = target_.position.head<2>();
    return down;
  }
  if (climb_) return flight::set_point(*climb_, motion_.vehicle().mode.jerk, time_ - *taken_off_);
  flight::SetPoint point = target_;
  const double age = time_ - target_time_;
  point.position += std::min(age, guided_timeout) * point.velocity;
  if (age > guided_timeout) point.velocity.setZero();
  return point;
}

flight::SetPoint SimulatedAutopilot::shaped(const flight::SetPoint& target_point) {
  const double jerk = *faults_.jerk, max = motion_.vehicle().mode.acceleration;
  if (!shaped_) shaped_ = flight::SetPoint{vehicle_.position(), vehicle_.velocity()};
  flight::SetPoint& now = *shaped_;
  const double acceleration_gain = jerk / max, speed_gain = 0.5 * acceleration_gain;
  const Vector3d velocity =
      target_point.velocity +
      square_root_controller(target_point.position - now.position, speed_gain, max);
  const Vector3d asked =
      bounded(square_root_controller(velocity - now.velocity, acceleration_gain, jerk), max);
  now.acceleration += bounded(asked - now.acceleration, jerk * step_time);
  now.position += step_time * now.velocity;
  now.velocity += step_time * now.acceleration;
  return now;
}

double SimulatedAutopilot::vehicle_pitch() const {
  constexpr double gravity = 9.80665;
  const double forward = acceleration_.x() * std::sin(yaw_) + acceleration_.y() * std::cos(yaw_);
  return faults_.wind_pitch - std::atan(forward / gravity);
}

void SimulatedAutopilot::step() {
  time_ += step_time;
  if (is_past(faults_.pilot_takes_over)) {
    mode_ = loiter;
    faults_.pilot_takes_over.reset();
  }
  yaw_ = turned(yaw_, target_yaw_, step_time * motion_.vehicle().mode.yaw_rate);
  pitch_ = turned(pitch_, target_pitch_, step_time * motion_.vehicle().gimbal_rate);
  if (is_armed_ && taken_off_) {
    flight::SetPoint point = target_point();
    if (faults_.jerk && mode_ == guided && !climb_) {
      point = shaped(point);
    } else {
      shaped_.reset();
    }
    point.position += faults_.drift * Vector3d(std::sin(0.7 * time_), std::cos(0.5 * time_),
                                               0.5 * std::sin(0.9 * time_));
    if (is_past(faults_.blown_away)) {
      point.position.x() += 0.5 * (time_ - *taken_off_ - *faults_.blown_away);
    }
    const Vector3d before = vehicle_.velocity();
    vehicle_.fly(point, Vector3d::Zero(), Vector3d::Zero(), step_time);
    acceleration_ = (vehicle_.velocity() - before) / step_time;
    track_.push_back(vehicle_.position());
    if (mode_ == landing && vehicle_.position().z() <= pad_.z()) is_armed_ = false;
  }
  if (time_ >= next_words_) speak();
}

template <class M>
void SimulatedAutopilot::send_frame(const M& message) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const std::uint8_t sequence = sequence_++;
  if (is_past(faults_.silent) || share(random_) < faults_.lost) return;
  Bytes frame = mavlink::encode(message, itself, sequence);
  if (share(random_) < faults_.damaged) frame[frame.size() / 2] ^= 0x10;
  const int times = share(random_) < faults_.doubled ? 2 : 1;
  for (int i = 0; i < times; ++i) outgoing_.insert(outgoing_.end(), frame.begin(), frame.end());
  if (share(random_) < faults_.late) late_ = frame;  // sent again after the next frame
}

void SimulatedAutopilot::speak() {
  next_words_ += words_period;
  outgoing_.insert(outgoing_.end(), late_.begin(), late_.end());
  late_.clear();
  constexpr std::uint64_t a_second = 10;
  const VehiclePosition vehicle_position = frame_.to_vehicle(vehicle_.position());
  const Vector3d& velocity = vehicle_.velocity();
  mavlink::GlobalPosition position;
  position.time_boot_ms = static_cast<std::uint32_t>(1e3 * time_);
  position.latitude = static_cast<std::int32_t>(std::lround(1e7 * vehicle_position.latitude_deg));
  position.longitude = static_cast<std::int32_t>(std::lround(1e7 * vehicle_position.longitude_deg));
  position.height_above_home =
      static_cast<std::int32_t>(std::lround(1e3 * vehicle_position.height_above_home));
  position.east_speed = static_cast<std::int16_t>(std::lround(100 * velocity.x()));
  position.north_speed = static_cast<std::int16_t>(std::lround(100 * velocity.y()));
  position.down_speed = static_cast<std::int16_t>(std::lround(-100 * velocity.z()));
  if (!is_past(faults_.position_stops)) send_frame(position);
  mavlink::Attitude attitude;
  attitude.yaw = static_cast<float>(std::remainder(yaw_, 2.0 * std::numbers::pi));
  attitude.pitch = static_cast<float>(vehicle_pitch());
  send_frame(attitude);
  mavlink::GimbalAttitude gimbal;
  double reported = faults_.gimbal_stuck ? 0.0 : pitch_;
  if (faults_.gimbal_against_vehicle) reported -= vehicle_pitch();
  gimbal.turn = {static_cast<float>(std::cos(0.5 * reported)), 0.0F,
                 static_cast<float>(std::sin(0.5 * reported)), 0.0F};
  send_frame(gimbal);
  if (words_++ % a_second != 0) return;
  mavlink::Heartbeat heartbeat;
  heartbeat.type = 2;
  heartbeat.autopilot = faults_.autopilot;
  heartbeat.custom_mode = mode_;
  heartbeat.base_mode = is_armed_ ? 128 : 0;
  send_frame(heartbeat);
  mavlink::SystemStatus status;
  const double used = vehicle_.energy() / (3600.0 * motion_.vehicle().battery_wh);
  const double left = is_past(faults_.battery_fails) ? 0.1 : faults_.battery - used;
  status.battery_remaining = static_cast<std::int8_t>(std::floor(100.0 * left));
  send_frame(status);
  mavlink::EstimatorStatus estimator;
  estimator.flags = is_past(faults_.estimate_lost) ? 1 | 2 | 4 | 128 : 1 | 2 | 4 | 8 | 16 | 32;
  send_frame(estimator);
}

Bytes SimulatedAutopilot::fly_on(double duration) {
  const double end = time_ + duration;
  while (time_ < end) step();
  return std::exchange(outgoing_, {});
}

std::unique_ptr<mavlink::Port> make_simulated_port(const flight::FlightOptions& flight,
                                                   const Vector3d& pad) {
  return std::make_unique<SimulatedPort>(flight, pad);
}

}  // namespace skycap::missions::online
