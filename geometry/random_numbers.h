/// Random numbers that are the same with every compiler: the standard prescribes those of the
/// engine, not those of its distributions.
#pragma once

#include <cstdint>
#include <random>

#include "geometry/split_mix.h"

namespace skycap::geometry {

/// A number in [0, 1) from the upper 53 of 64 random bits.
constexpr double unit_number(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// A sequence of random numbers: the Mersenne Twister of 64 bits. Also an engine, for std::shuffle
/// and the distributions.
class RandomNumbers {
 public:
  using result_type = std::uint64_t;

  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}
  /// Sequences of different seeds or streams are unrelated.
  RandomNumbers(std::uint64_t seed, std::uint64_t stream)
      : engine_(split_mix(split_mix(seed) ^ stream)) {}

  static constexpr result_type min() { return std::mt19937_64::min(); }
  static constexpr result_type max() { return std::mt19937_64::max(); }
  result_type operator()() { return engine_(); }

  /// In [0, 1).
  double uniform() { return unit_number(engine_()); }
  /// Draws a number in [least, most).
  double between(double least, double most) { return least + (most - least) * uniform(); }
  /// Draws an integer from `least` to `most`, both included.
  int integer(int least, int most) {
    return least + static_cast<int>(engine_() % static_cast<std::uint64_t>(most - least + 1));
  }
  /// Draws from the normal distribution with mean 0 and standard deviation 1.
  double normal();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// A short sequence that costs nothing to begin, such as one for each pixel: SplitMix64.
class ShortRandomNumbers {
 public:
  /// Mixes the seed: seeds that follow each other must not give the same sequence, shifted.
  explicit ShortRandomNumbers(std::uint64_t seed) : state_(split_mix(seed)) {}

  /// In [0, 1).
  double uniform() {
    const std::uint64_t bits = split_mix(state_);
    state_ += split_mix_step;
    return unit_number(bits);
  }

 private:
  std::uint64_t state_;
};

}  // namespace skycap::geometry
