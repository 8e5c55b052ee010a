/// Values as the bytes that binary files have, whatever the processor.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace skycap::missions::scan {

/// Writes a number to `bytes`, lowest byte first.
template <typename Value>
void store(std::uint8_t* bytes, Value value) {
  static_assert(std::is_arithmetic_v<Value>);
  std::memcpy(bytes, &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes, bytes + sizeof value);
}

}  // namespace skycap::missions::scan
