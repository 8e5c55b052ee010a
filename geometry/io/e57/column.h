/// The values of one field of an E57 file's records, bit behind bit as they come in packets.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace skycap::geometry::e57 {

class Column {
 public:
  /// Of values of 0 to 64 bits.
  explicit Column(unsigned bits) : bits_(bits) {}

  /// Bytes that follow those before.
  void append(std::string_view bytes) { bytes_ += bytes; }

  /// How many values have come and are not taken.
  std::uint64_t available() const;

  /// The next values, all of which have come.
  void take(std::span<std::uint64_t> values);

  std::size_t bytes_waiting() const { return bytes_.size(); }

 private:
  unsigned bits_;
  std::string bytes_;
  std::size_t first_bit_ = 0;  ///< of those that are not taken
};

}  // namespace skycap::geometry::e57
