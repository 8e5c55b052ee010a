/// Transport and clock of a link: sockets with the system clock, or a simulated autopilot with its
/// own time in tests.
#pragma once

#include <span>

#include "flight/mavlink/frame.h"

namespace skycap::flight::mavlink {

class Port {
 public:
  virtual ~Port() = default;

  /// Sends bytes, which may be lost.
  virtual void send(std::span<const std::uint8_t> bytes) = 0;

  /// Returns the received bytes. Waits at most `patience` [s] for the first.
  virtual Bytes receive(double patience) = 0;

  /// Returns the time since a fixed moment [s]. Monotonic.
  virtual double now() const = 0;
};

}  // namespace skycap::flight::mavlink
