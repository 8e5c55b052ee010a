/// Little-endian values among a file's bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>

namespace skycap::geometry {

/// The value at a place of a file's bytes, all of which are known to be there.
template <typename Value>
Value value_at(const char* bytes, std::size_t place) {
  static_assert(std::endian::native == std::endian::little, "values in files are little-endian");
  Value value;
  std::memcpy(&value, bytes + place, sizeof value);
  return value;
}

/// Puts the value at a place of bytes, all of which are there.
template <typename Value>
void put_value(char* bytes, std::size_t place, Value value) {
  static_assert(std::endian::native == std::endian::little, "values in files are little-endian");
  std::memcpy(bytes + place, &value, sizeof value);
}

}  // namespace skycap::geometry
