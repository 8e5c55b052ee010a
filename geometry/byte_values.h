/// Access to little-endian values in the bytes of a file.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace skycap::geometry {

/// Returns the value stored at byte offset `offset`. The caller guarantees that all its bytes
/// exist.
template <typename Value>
Value value_at(const char* bytes, std::size_t offset) {
  static_assert(std::endian::native == std::endian::little, "values in files are little-endian");
  Value value;
  std::memcpy(&value, bytes + offset, sizeof value);
  return value;
}

/// Writes `value` at byte offset `offset`. The caller guarantees that the buffer is large enough.
template <typename Value>
void put_value(char* bytes, std::size_t offset, Value value) {
  static_assert(std::endian::native == std::endian::little, "values in files are little-endian");
  std::memcpy(bytes + offset, &value, sizeof value);
}
template <typename Value>
void put_value(std::uint8_t* bytes, std::size_t offset, Value value) {
  put_value(reinterpret_cast<char*>(bytes), offset, value);
}

/// Appends the bytes of a number, or of an array of numbers without padding, to `bytes`.
template <typename Value>
void append_value(std::string& bytes, const Value& value) {
  static_assert(std::endian::native == std::endian::little, "values in files are little-endian");
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace skycap::geometry
