/// Access to the bit fields of a double.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace skycap::mathematics {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

inline constexpr int mantissa_bits = 52;
inline constexpr int exponent_bias = 1023;

constexpr std::uint64_t to_bits(double x) { return std::bit_cast<std::uint64_t>(x); }
constexpr bool is_negative(double x) { return to_bits(x) >> 63 != 0; }
constexpr double magnitude(double x) { return std::bit_cast<double>(to_bits(x) & ~(1ULL << 63)); }
constexpr double copy_sign(double x, double sign) {
  return std::bit_cast<double>(to_bits(magnitude(x)) | (to_bits(sign) & (1ULL << 63)));
}
constexpr bool is_nan(double x) { return x != x; }
constexpr bool is_finite(double x) { return magnitude(x) < infinity; }

/// Returns e of a normal number x with 2^e <= |x| < 2^(e + 1).
constexpr int binary_exponent(double x) {
  return static_cast<int>(to_bits(x) >> mantissa_bits & 0x7FF) - exponent_bias;
}
/// Returns 2^e for e in [-1022, 1023].
constexpr double power_of_two(int e) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(e + exponent_bias) << mantissa_bits);
}

/// Returns x * 2^e for e in [-2044, 2046], rounded once unless the result is subnormal.
constexpr double scaled(double x, int e) {
  const int half = e / 2;
  return x * power_of_two(half) * power_of_two(e - half);
}

/// Returns the nearest integer for |x| < 2^51.
constexpr double rounded(double x) {
  constexpr double shift = 0x1.8p52;
  return (x + shift) - shift;
}

}  // namespace skycap::mathematics
