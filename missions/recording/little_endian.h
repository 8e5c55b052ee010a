/// Values as the bytes that binary files have, whatever the processor.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace skycap::missions::recording {

/// Writes a number to `bytes`, lowest byte first.
template <typename Value>
void store(std::uint8_t* bytes, Value value) {
  static_assert(std::is_arithmetic_v<Value>);
  std::memcpy(bytes, &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes, bytes + sizeof value);
}

/// Bytes that grow value by value.
class Bytes {
 public:
  template <typename Value>
  Bytes& add(Value value) {
    bytes_.resize(bytes_.size() + sizeof value);
    store(bytes_.data() + bytes_.size() - sizeof value, value);
    return *this;
  }
  /// The text, cut or filled with zeros to `size` bytes.
  Bytes& add_text(std::string_view text, std::size_t size) {
    const std::size_t kept = std::min(text.size(), size);
    bytes_.insert(bytes_.end(), text.begin(), text.begin() + static_cast<std::ptrdiff_t>(kept));
    bytes_.resize(bytes_.size() + size - kept, 0);
    return *this;
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace skycap::missions::recording
