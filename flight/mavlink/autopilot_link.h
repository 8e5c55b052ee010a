/// MAVLink connection to one autopilot: sends a heartbeat every second, receives continuously, and
/// repeats commands until they are acknowledged.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "flight/mavlink/port.h"
#include "flight/mavlink/vehicle_state.h"

namespace skycap::flight::mavlink {

/// Own address: the system ID of ground stations, whose loss autopilots detect (FS_GCS_ENABLE), and
/// MAV_COMP_ID_ONBOARD_COMPUTER.
inline constexpr Address our_address{255, 191};

class AutopilotLink {
 public:
  /// Keeps a reference to `port`.
  explicit AutopilotLink(Port& port) : port_(port), reader_(guided_extra_byte) {}

  /// Receives messages and sends heartbeats for `duration` [s].
  void spin(double duration);

  double now() const { return port_.now(); }
  const VehicleState& state() const { return state_; }

  /// Sends a command until it is acknowledged. Returns MAV_RESULT, or std::nullopt after a timeout
  /// of some seconds. Requires that a message from the vehicle has been received.
  std::optional<std::uint8_t> command(std::uint16_t number, const std::array<float, 7>& params);

  /// Asks for a parameter by its name, of at most 16 letters. Returns its value, or std::nullopt
  /// after a timeout of some seconds: the autopilot may not have it. Requires that a message from
  /// the vehicle has been received.
  std::optional<double> parameter(const std::string& name);

  /// Sends a setpoint once. Fills in its target and time.
  void send(PositionTarget target);

 private:
  template <class M>
  void send_message(const M& message) {
    port_.send(encode(message, our_address, sequence_++));
  }
  void beat();

  Port& port_;
  FrameReader reader_;
  VehicleState state_;
  std::uint8_t sequence_ = 0;
  std::optional<double> last_beat_;
};

}  // namespace skycap::flight::mavlink
