/// Little-endian values among a file's bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

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
template <typename Value>
void put_value(std::uint8_t* bytes, std::size_t place, Value value) {
  put_value(reinterpret_cast<char*>(bytes), place, value);
}

/// Appends a number, or numbers without padding between them, to bytes.
template <typename Value>
void append_value(std::string& bytes, const Value& value) {
  static_assert(std::endian::native == std::endian::little, "values in files are little-endian");
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace skycap::geometry
