#include "geometry/io/las/colour_coder.h"

#include <algorithm>
#include <cstddef>

namespace skycap::geometry::las {
namespace {

using Bytes = std::array<std::array<int, 3>, 2>;  // low bytes, high bytes

Bytes to_bytes(const Colour& colour) {
  Bytes bytes{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    bytes[0][channel] = colour[channel] & 0xFF;
    bytes[1][channel] = colour[channel] >> 8;
  }
  return bytes;
}

std::uint32_t find_changed_bytes(const Bytes& old, const Bytes& now) {
  std::uint32_t changed = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (old[i % 2][i / 2] != now[i % 2][i / 2]) changed |= 1U << i;
  }
  const auto is_grey = [](const auto& half) { return half[1] == half[0] && half[2] == half[0]; };
  return std::ranges::all_of(now, is_grey) ? changed : changed | 1U << 6;
}

}  // namespace

template <typename Coder>
Colour ColourCoder::code(Coder& coder, const Colour& last, const Colour& value) {
  const Bytes old = to_bytes(last);
  Bytes bytes = to_bytes(value);
  std::uint32_t changed = 0;
  if constexpr (Coder::encodes) changed = find_changed_bytes(old, bytes);
  changed = coder.symbol(changed_, changed);
  // An unchanged byte equals that of the last colour. Otherwise it is the prediction plus a
  // correction.
  const auto code_byte = [&](std::size_t channel, std::size_t half, int change) {
    const std::size_t i = 2 * channel + half;
    int& byte = bytes[half][channel];
    const int last_byte = old[half][channel], predicted = std::clamp(last_byte + change, 0, 255);
    if ((changed >> i & 1) == 0) {
      byte = last_byte;
      return;
    }
    const auto correction = static_cast<std::uint32_t>(byte - predicted) & 0xFF;
    byte = (static_cast<int>(coder.symbol(changes_[i], correction)) + predicted) & 0xFF;
  };
  for (const std::size_t half : {0, 1}) code_byte(0, half, 0);
  const bool is_grey = (changed >> 6 & 1) == 0;
  for (const std::size_t half : {0, 1}) {
    std::array<int, 3>& now = bytes[half];
    if (is_grey) {
      now[1] = now[2] = now[0];
      continue;
    }
    const int red = now[0] - old[half][0];
    code_byte(1, half, red);
    code_byte(2, half, (red + now[1] - old[half][1]) / 2);
  }
  Colour colour;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    colour[channel] = static_cast<std::uint16_t>(bytes[1][channel] << 8 | bytes[0][channel]);
  }
  return colour;
}

template Colour ColourCoder::code(ArithmeticDecoder& coder, const Colour& last,
                                  const Colour& value);
template Colour ColourCoder::code(ArithmeticEncoder& coder, const Colour& last,
                                  const Colour& value);

}  // namespace skycap::geometry::las
