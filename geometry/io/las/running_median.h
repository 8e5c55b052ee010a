/// Running median of five numbers. A new number replaces alternately the largest and the smallest
/// number (LAZ specification 1.4, section 7).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace skycap::geometry::las {

class RunningMedian {
 public:
  std::int32_t get() const { return sorted_[2]; }

  void add(std::int32_t value) {
    const std::int32_t median = sorted_[2];
    if (drops_largest_) {
      std::size_t i = 4;
      for (; i > 0 && value < sorted_[i - 1]; --i) sorted_[i] = sorted_[i - 1];
      sorted_[i] = value;
      drops_largest_ = value < median;
    } else {
      std::size_t i = 0;
      for (; i < 4 && sorted_[i + 1] < value; ++i) sorted_[i] = sorted_[i + 1];
      sorted_[i] = value;
      drops_largest_ = value <= median;
    }
  }

 private:
  std::array<std::int32_t, 5> sorted_{};
  bool drops_largest_ = true;
};

}  // namespace skycap::geometry::las
