/// Messages that are spoiled on the wire: while one of these lives, what this process sends of its
/// topics over RTPS keeps its headers, and random bytes of the serialised data in it are others.
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

  /// Pieces of data that were spoiled so far.
  static std::size_t count();
};

}  // namespace skycap::ros2
