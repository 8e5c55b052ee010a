/// Random numbers that are identical with every compiler. The standard specifies the results of its
/// engines, but not of its distributions.
#pragma once

#include <cstdint>
#include <random>

#include "geometry/split_mix.h"

namespace skycap::geometry {

/// Converts the upper 53 of 64 random bits to a number in [0, 1).
constexpr double unit_number(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Random number generator based on the 64-bit Mersenne Twister. It is also a standard engine, for
/// std::shuffle and the distributions.
class RandomNumbers {
 public:
  using result_type = std::uint64_t;

  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}
  /// Creates an independent sequence for each pair of seed and stream.
  RandomNumbers(std::uint64_t seed, std::uint64_t stream)
      : engine_(split_mix(split_mix(seed) ^ stream)) {}

  static constexpr result_type min() { return std::mt19937_64::min(); }
  static constexpr result_type max() { return std::mt19937_64::max(); }
  result_type operator()() { return engine_(); }

  /// Draws a number in [0, 1).
  double uniform() { return unit_number(engine_()); }
  /// Draws a number in [least, most).
  double between(double min_value, double max_value) {
    return min_value + (max_value - min_value) * uniform();
  }
  /// Draws an integer from `min_value` to `max_value`, both inclusive.
  int integer(int min_value, int max_value) {
    return min_value +
           static_cast<int>(engine_() % static_cast<std::uint64_t>(max_value - min_value + 1));
  }
  /// Draws from the normal distribution with mean 0 and standard deviation 1.
  double normal();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// SplitMix64 generator for short sequences, such as one per pixel. Construction takes almost no
/// time.
class ShortRandomNumbers {
 public:
  /// Hashes the seed, because consecutive seeds would otherwise give shifted copies of the same
  /// sequence.
  explicit ShortRandomNumbers(std::uint64_t seed) : state_(split_mix(seed)) {}

  /// Draws a number in [0, 1).
  double uniform() {
    const std::uint64_t bits = split_mix(state_);
    state_ += split_mix_step;
    return unit_number(bits);
  }

 private:
  std::uint64_t state_;
};

}  // namespace skycap::geometry
