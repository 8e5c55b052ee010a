/// Where the bytes of a link go to and come from, and what time it is there: sockets and the clock
/// on the wall, or an autopilot in a test, whose time is as fast as it is computed.
#pragma once

#include <span>

#include "flight/link/frame.h"

namespace skycap::flight::mavlink {

class Port {
 public:
  virtual ~Port() = default;

  /// May lose it, as links do.
  virtual void send(std::span<const std::uint8_t> bytes) = 0;

  /// What has come; waits for something until so many seconds have passed.
  virtual Bytes receive(double patience) = 0;

  /// Seconds since some moment; never goes back.
  virtual double now() const = 0;
};

}  // namespace skycap::flight::mavlink
