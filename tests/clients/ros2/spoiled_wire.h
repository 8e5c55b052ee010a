/// Corrupts messages on the wire. While an instance exists, random bytes of the serialised topic
/// data that this process sends through RTPS are changed. The headers remain valid.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::ros2 {

class CorruptedWire {
 public:
  explicit CorruptedWire(std::uint32_t seed);
  CorruptedWire(const CorruptedWire&) = delete;
  CorruptedWire& operator=(const CorruptedWire&) = delete;
  ~CorruptedWire();

  /// Returns the number of data submessages corrupted so far.
  static std::size_t count();
};

}  // namespace skycap::ros2
