/// The talk with one autopilot: we are heard once a second, it is heard all the time, commands are
/// repeated until they are answered.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "flight/link/port.h"
#include "flight/link/vehicle_state.h"

namespace skycap::flight::mavlink {

/// Us: the number that ground stations have, whose silence autopilots notice (FS_GCS_ENABLE), and
/// MAV_COMP_ID_ONBOARD_COMPUTER.
inline constexpr Address our_address{255, 191};

class AutopilotLink {
 public:
  /// Keeps a reference.
  explicit AutopilotLink(Port& port) : port_(port), reader_(guided_extra_byte) {}

  /// Hears and is heard for so many seconds.
  void spin(double duration);

  double now() const { return port_.now(); }
  const VehicleState& state() const { return state_; }

  /// Sends a command until it is answered: MAV_RESULT, or nothing if no answer comes in some
  /// seconds. The vehicle must have been heard.
  std::optional<std::uint8_t> command(std::uint16_t number, const std::array<float, 7>& params);

  /// Sends a set point once. Its target and time are filled in.
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
