/// SplitMix64 hash and generator (G. Steele, D. Lea and C. Flood, "Fast splittable pseudorandom
/// number generators", OOPSLA 2014). It distributes consecutive numbers over the whole range.
#pragma once

#include <cstdint>

namespace skycap::geometry {

/// Difference between consecutive states of a sequence.
inline constexpr std::uint64_t split_mix_step = 0x9E3779B97F4A7C15U;

/// Returns the number for a state. A bijection in which every output bit depends on every input
/// bit.
constexpr std::uint64_t split_mix(std::uint64_t state) {
  state += split_mix_step;
  state = (state ^ state >> 30) * 0xBF58476D1CE4E5B9U;
  state = (state ^ state >> 27) * 0x94D049BB133111EBU;
  return state ^ state >> 31;
}

// Reference values of the first author's generator with the initial state zero.
static_assert(split_mix(0) == 0xE220A8397B1DCDAFU);
static_assert(split_mix(split_mix_step) == 0x6E789E6AA1B965F4U);

}  // namespace skycap::geometry
