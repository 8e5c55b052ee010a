/// Coordinate decoder for all item versions. x and y are predicted by the median of recent steps, z
/// by the previous return of the same kind.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "geometry/io/las/integer_decoder.h"
#include "geometry/io/las/running_median.h"

namespace skycap::geometry::las {

class PositionDecoder {
 public:
  void reset() {
    for (IntegerDecoder* numbers : {&x_, &y_, &z_}) numbers->reset();
  }

  struct Step {
    std::int32_t x = 0, y = 0;
  };
  /// Reads a step and adds it to the medians. `is_single` is true for the only return of a pulse.
  Step read_step(ArithmeticDecoder& decoder, RunningMedian& x, RunningMedian& y, bool is_single);

  /// Reads the z coordinate of the point whose step was read last.
  std::int32_t read_height(ArithmeticDecoder& decoder, std::int32_t last, bool is_single);

 private:
  static std::size_t context(std::uint32_t magnitude, std::uint32_t largest, bool is_single) {
    return std::min(magnitude & ~1U, largest) + (is_single ? 1 : 0);
  }

  IntegerDecoder x_{32, 2}, y_{32, 22}, z_{32, 20};
};

inline PositionDecoder::Step PositionDecoder::read_step(ArithmeticDecoder& decoder,
                                                        RunningMedian& x, RunningMedian& y,
                                                        bool is_single) {
  Step step;
  step.x = x_.read_signed(decoder, x.get(), is_single ? 1 : 0);
  x.add(step.x);
  step.y = y_.read_signed(decoder, y.get(), context(x_.magnitude(), 20, is_single));
  y.add(step.y);
  return step;
}

inline std::int32_t PositionDecoder::read_height(ArithmeticDecoder& decoder, std::int32_t last,
                                                 bool is_single) {
  const std::uint32_t magnitude = (x_.magnitude() + y_.magnitude()) / 2;
  return z_.read_signed(decoder, last, context(magnitude, 18, is_single));
}

/// Returns a + b in two's complement without overflow, as the encoder does.
inline std::int32_t wrapped_sum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

}  // namespace skycap::geometry::las
