/// What an autopilot has said of its vehicle, and when.
///
/// Nothing that it says is believed unseen: numbers that are not finite or beyond the Earth, and
/// what is older than what was heard before, change nothing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/link/frame.h"
#include "flight/link/guided_messages.h"

namespace skycap::flight::mavlink {

/// Where the vehicle takes itself to be.
struct HeardPosition {
  double time = 0.0;  ///< heard, by the port's clock [s]
  std::uint32_t boot_ms = 0;
  double latitude_deg = 0.0, longitude_deg = 0.0;
  double height_above_home = 0.0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< east, north, up [m/s]
};

struct HeardHeartbeat {
  double time = 0.0;
  std::uint8_t autopilot = 0, type = 0;  ///< MAV_AUTOPILOT, MAV_TYPE
  std::uint32_t mode = 0;                ///< the autopilot's own number of it
  bool is_armed = false;
};

class VehicleState {
 public:
  /// Takes in a frame heard at `now`. The first autopilot that is heard is the vehicle; frames of
  /// others, and those that come twice or late, are passed over.
  void hear(const Frame& frame, double now);

  std::optional<double> last_heard() const { return last_heard_; }  ///< anything of the vehicle
  const std::optional<Address>& autopilot() const { return autopilot_; }
  const std::optional<HeardHeartbeat>& heartbeat() const { return heartbeat_; }
  const std::optional<HeardPosition>& position() const { return position_; }
  std::optional<double> yaw() const { return yaw_; }             ///< clockwise from north [rad]
  std::optional<double> pitch() const { return body_pitch_; }    ///< of the vehicle, nose up [rad]
  std::optional<double> gimbal_pitch() const { return pitch_; }  ///< as reported, 0: horizon [rad]
  std::optional<double> battery() const { return battery_; }     ///< share that is left
  std::optional<std::uint16_t> estimator() const { return estimator_; }  ///< EKF_STATUS_FLAGS

  /// The answer to a command, heard since forget_answer() was called for it.
  std::optional<std::uint8_t> answer(std::uint16_t command) const;
  void forget_answer(std::uint16_t command) { answers_.erase(command); }

  /// What the autopilot last warned of, printable; empty: nothing.
  const std::string& warning() const { return warning_; }

 private:
  bool is_new(const Frame& frame);
  void hear_position(const GlobalPosition& message, double now);
  void hear_autopilot(const Frame& frame, double now);

  std::optional<double> last_heard_;
  std::optional<Address> autopilot_;
  std::map<std::uint8_t, std::uint8_t> sequences_;  ///< last heard, by component
  std::optional<HeardHeartbeat> heartbeat_;
  std::optional<HeardPosition> position_;
  std::optional<double> yaw_, body_pitch_, pitch_, battery_;
  std::optional<std::uint16_t> estimator_;
  std::map<std::uint16_t, std::uint8_t> answers_;
  std::string warning_;
};

}  // namespace skycap::flight::mavlink
