#include "geometry/io/las/colour_decoder.h"

#include <algorithm>
#include <cstddef>

namespace skycap::geometry::las {

Colour ColourDecoder::read(ArithmeticDecoder& decoder, const Colour& last) {
  const std::uint32_t changed = decoder.symbol(changed_);
  std::array<std::array<int, 3>, 2> bytes{}, old{};  // low bytes, high bytes
  for (std::size_t channel = 0; channel < 3; ++channel) {
    old[0][channel] = last[channel] & 0xFF;
    old[1][channel] = last[channel] >> 8;
  }
  // An unchanged byte equals that of the last colour. Otherwise it is the prediction plus a
  // correction.
  const auto read_byte = [&](std::size_t channel, std::size_t half, int change) {
    const std::size_t i = 2 * channel + half;
    int& byte = bytes[half][channel];
    byte = old[half][channel];
    if ((changed >> i & 1) == 0) return;
    byte =
        (static_cast<int>(decoder.symbol(changes_[i])) + std::clamp(byte + change, 0, 255)) & 0xFF;
  };
  for (const std::size_t half : {0, 1}) read_byte(0, half, 0);
  const bool is_grey = (changed >> 6 & 1) == 0;
  for (const std::size_t half : {0, 1}) {
    std::array<int, 3>& now = bytes[half];
    if (is_grey) {
      now[1] = now[2] = now[0];
      continue;
    }
    const int red = now[0] - old[half][0];
    read_byte(1, half, red);
    read_byte(2, half, (red + now[1] - old[half][1]) / 2);
  }
  Colour colour;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    colour[channel] = static_cast<std::uint16_t>(bytes[1][channel] << 8 | bytes[0][channel]);
  }
  return colour;
}

}  // namespace skycap::geometry::las
