/// Latest state received from an autopilot, with times of reception.
///
/// Input is untrusted. Values that are not finite or outside the valid range, and messages older
/// than the latest, are ignored.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/mavlink/frame.h"
#include "flight/mavlink/guided_messages.h"

namespace skycap::flight::mavlink {

/// Position estimate of the vehicle.
struct HeardPosition {
  double time = 0.0;  ///< Time of reception on the port's clock [s].
  std::uint32_t boot_ms = 0;
  double latitude_deg = 0.0, longitude_deg = 0.0;
  double height_above_home = 0.0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< East, north and up [m/s].
};

struct HeardHeartbeat {
  double time = 0.0;
  std::uint8_t autopilot = 0, type = 0;  ///< MAV_AUTOPILOT and MAV_TYPE.
  std::uint32_t mode = 0;                ///< Autopilot-specific flight mode number.
  bool is_armed = false;
};

class VehicleState {
 public:
  /// Processes a frame received at `now` [s]. The first autopilot heard becomes the vehicle. Frames
  /// from other systems, and duplicate or late ones, are ignored.
  void hear(const Frame& frame, double now);

  /// Returns the time of the last message from the vehicle [s].
  std::optional<double> last_heard() const { return last_heard_; }
  const std::optional<Address>& autopilot() const { return autopilot_; }
  const std::optional<HeardHeartbeat>& heartbeat() const { return heartbeat_; }
  const std::optional<HeardPosition>& position() const { return position_; }
  /// Returns the heading, clockwise from north [rad].
  std::optional<double> yaw() const { return yaw_; }
  /// Returns the pitch of the vehicle, positive nose up [rad].
  std::optional<double> pitch() const { return body_pitch_; }
  /// Returns the reported gimbal pitch, 0 at the horizon [rad].
  std::optional<double> gimbal_pitch() const { return pitch_; }
  /// Returns the remaining fraction of the battery charge.
  std::optional<double> battery() const { return battery_; }
  /// Returns the EKF_STATUS_FLAGS.
  std::optional<std::uint16_t> estimator() const { return estimator_; }

  /// Returns the acknowledgement of a command since the last forget_answer(), or std::nullopt.
  std::optional<std::uint8_t> answer(std::uint16_t command) const;
  void forget_answer(std::uint16_t command) { answers_.erase(command); }

  /// Returns the last value of a parameter, in its unit; std::nullopt if none was received.
  std::optional<double> parameter(const std::string& name) const;

  /// Returns the last warning of the autopilot as printable text, or an empty string.
  const std::string& warning() const { return warning_; }

 private:
  bool is_new(const Frame& frame);
  void hear_position(const GlobalPosition& message, double now);
  void hear_autopilot(const Frame& frame, double now);

  std::optional<double> last_heard_;
  std::optional<Address> autopilot_;
  std::map<std::uint8_t, std::uint8_t> sequences_;  ///< Last sequence number per component.
  std::optional<HeardHeartbeat> heartbeat_;
  std::optional<HeardPosition> position_;
  std::optional<double> yaw_, body_pitch_, pitch_, battery_;
  std::optional<std::uint16_t> estimator_;
  std::map<std::uint16_t, std::uint8_t> answers_;
  std::map<std::string, double> parameters_;
  std::string warning_;
};

}  // namespace skycap::flight::mavlink
