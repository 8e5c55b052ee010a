/// Bit stream of the values of one field of E57 records, collected from consecutive packets.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace skycap::geometry::e57 {

class Column {
 public:
  /// `bits` is the size of a value, from 0 to 64.
  explicit Column(unsigned bits) : bits_(bits) {}

  /// Appends the next bytes of the stream.
  void append(std::string_view bytes) { bytes_ += bytes; }

  /// Returns the number of complete values that have not been taken.
  std::uint64_t available() const;

  /// Takes the next values. Requires values.size() <= available().
  void take(std::span<std::uint64_t> values);

  std::size_t bytes_waiting() const { return bytes_.size(); }

 private:
  unsigned bits_;
  std::string bytes_;
  std::size_t first_bit_ = 0;  ///< position of the first value that has not been taken
};

}  // namespace skycap::geometry::e57
