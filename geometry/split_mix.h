/// Numbers that follow each other become numbers all over the range: SplitMix64 of G. Steele, D.
/// Lea and C. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
#pragma once

#include <cstdint>

namespace skycap::geometry {

/// What a sequence's states are apart.
inline constexpr std::uint64_t split_mix_step = 0x9E3779B97F4A7C15U;

/// The number that follows from a state: a bijection, every bit of which depends on every bit.
constexpr std::uint64_t split_mix(std::uint64_t state) {
  state += split_mix_step;
  state = (state ^ state >> 30) * 0xBF58476D1CE4E5B9U;
  state = (state ^ state >> 27) * 0x94D049BB133111EBU;
  return state ^ state >> 31;
}

// Of the first author's own generator, started at zero.
static_assert(split_mix(0) == 0xE220A8397B1DCDAFU);
static_assert(split_mix(split_mix_step) == 0x6E789E6AA1B965F4U);

}  // namespace skycap::geometry
