#include "geometry/io/e57/column.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "geometry/byte_values.h"

namespace skycap::geometry::e57 {

std::uint64_t Column::available() const {
  if (bits_ == 0) return std::numeric_limits<std::uint64_t>::max();
  return (bytes_.size() * 8 - first_bit_) / bits_;
}

void Column::take(std::span<std::uint64_t> values) {
  assert(values.size() <= available());
  if (bits_ == 0) {
    std::ranges::fill(values, 0);
    return;
  }
  constexpr std::size_t word = sizeof(std::uint64_t);
  const std::size_t size = bytes_.size();
  bytes_.append(word + 1, '\0');  // allows reading a whole word at the start of every value
  const std::uint64_t mask = std::numeric_limits<std::uint64_t>::max() >> (64 - bits_);
  std::size_t bit = first_bit_;
  for (std::uint64_t& value : values) {
    const std::size_t byte = bit / 8, shift = bit % 8;
    value = value_at<std::uint64_t>(bytes_.data(), byte) >> shift;
    if (shift + bits_ > 64) {
      value |= std::uint64_t{static_cast<std::uint8_t>(bytes_[byte + word])} << (64 - shift);
    }
    value &= mask;
    bit += bits_;
  }
  bytes_.resize(size);
  first_bit_ = bit;
  if (first_bit_ / 8 <= size / 2)
    return;  // limits the number of moves of the remaining bytes, even for small values
  bytes_.erase(0, first_bit_ / 8);
  first_bit_ %= 8;
}

}  // namespace skycap::geometry::e57
