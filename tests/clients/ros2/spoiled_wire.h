/// Messages that are spoiled on the wire: while one of these lives, what this process sends of its
/// topics over RTPS keeps its headers, and random bytes of the serialised data in it are others.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::ros2 {

class SpoiledWire {
 public:
  explicit SpoiledWire(std::uint32_t seed);
  SpoiledWire(const SpoiledWire&) = delete;
  SpoiledWire& operator=(const SpoiledWire&) = delete;
  ~SpoiledWire();

  /// Pieces of data that were spoiled so far.
  static std::size_t count();
};

}  // namespace skycap::ros2
