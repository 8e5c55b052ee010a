/// Coordinate coder for all item versions. x and y are predicted by the median of recent steps, z
/// by the previous return of the same kind.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "geometry/io/las/integer_coder.h"
#include "geometry/io/las/running_median.h"

namespace skycap::geometry::las {

class PositionCoder {
 public:
  void reset() {
    for (IntegerCoder* numbers : {&x_, &y_, &z_}) numbers->reset();
  }

  struct Step {
    std::int32_t x = 0, y = 0;
  };
  /// Codes a step and adds it to the medians. `is_single` is true for the only return of a pulse.
  template <typename Coder>
  Step code_step(Coder& coder, RunningMedian& x, RunningMedian& y, bool is_single, Step value);

  /// Codes the z coordinate of the point whose step was coded last.
  template <typename Coder>
  std::int32_t code_height(Coder& coder, std::int32_t last, bool is_single, std::int32_t value = 0);

 private:
  static std::size_t context(std::uint32_t magnitude, std::uint32_t largest, bool is_single) {
    return std::min(magnitude & ~1U, largest) + (is_single ? 1 : 0);
  }

  IntegerCoder x_{32, 2}, y_{32, 22}, z_{32, 20};
};

template <typename Coder>
PositionCoder::Step PositionCoder::code_step(Coder& coder, RunningMedian& x, RunningMedian& y,
                                             bool is_single, Step value) {
  Step step;
  step.x = x_.code_signed(coder, x.get(), value.x, is_single ? 1 : 0);
  x.add(step.x);
  step.y = y_.code_signed(coder, y.get(), value.y, context(x_.magnitude(), 20, is_single));
  y.add(step.y);
  return step;
}

template <typename Coder>
std::int32_t PositionCoder::code_height(Coder& coder, std::int32_t last, bool is_single,
                                        std::int32_t value) {
  const std::uint32_t magnitude = (x_.magnitude() + y_.magnitude()) / 2;
  return z_.code_signed(coder, last, value, context(magnitude, 18, is_single));
}

/// Returns a + b in two's complement without overflow, as the encoder does.
inline std::int32_t wrapped_sum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

/// Returns a - b in two's complement without overflow.
inline std::int32_t wrapped_difference(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}

}  // namespace skycap::geometry::las
