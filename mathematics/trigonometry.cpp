#include <array>
#include <bit>
#include <cstdint>

#include "mathematics/bits.h"
#include "mathematics/double_double.h"
#include "mathematics/elementary.h"

namespace skycap::mathematics {
namespace {

// 2 / pi in words of 64 bits after the binary point.
constexpr std::uint64_t inverse_half_pi[] = {
    0xA2F9836E4E441529, 0xFC2757D1F534DDC0, 0xDB6295993C439041, 0xFE5163ABDEBBC561,
    0xB7246E3A424DD2E0, 0x06492EEA09D1921C, 0xFE1DEB1CB129A73E, 0xE88235F52EBB4484,
    0xE99C7026B45F7E41, 0x3991D639835339F4, 0x9C845F8BBDF9283B, 0x1FF897FFDE05980F,
    0xEF2F118B5A0A6D1F, 0x6D367ECF27CB09B7, 0x4F463F669E5FEA2D, 0x7527BAC7EBE5F17B,
    0x3D0739F78A5292EA, 0x6BFB5FB11F8D5D08, 0x56033046FC7B6BAB, 0xF0CFBC209AF4361D};

// Returns 64 bits of 2 / pi, starting with the bit of weight 2^-first. Bits before the binary point
// are zero.
std::uint64_t inverse_half_pi_bits(int first) {
  const auto word = [](int i) { return i < 0 ? std::uint64_t{0} : inverse_half_pi[i]; };
  const int position = first - 1 + 64;  // bit position, counted from a leading word of zeros
  const int i = position / 64 - 1, shift = position % 64;
  return shift == 0 ? word(i) : word(i) << shift | word(i + 1) >> (64 - shift);
}

// Number of 192 bits; most significant word first.
struct WideNumber {
  std::uint64_t words[3];
};

// Returns m (2 / pi) 2^e modulo 4, times 2^190, for m < 2^53 and e in [-60, 971]. Truncation of 2 /
// pi makes the result too small by less than m.
WideNumber quarter_turns(std::uint64_t m, int e) {
  __extension__ using Product = unsigned __int128;
  const int first = e - 1;  // bit with weight 2 in the product with 2^e
  const Product low = Product{m} * inverse_half_pi_bits(first + 128);
  const Product middle = Product{m} * inverse_half_pi_bits(first + 64) + (low >> 64);
  const std::uint64_t high =
      m * inverse_half_pi_bits(first) + static_cast<std::uint64_t>(middle >> 64);
  return {{high, static_cast<std::uint64_t>(middle), static_cast<std::uint64_t>(low)}};
}

WideNumber negated(const WideNumber& n) {
  WideNumber result;
  std::uint64_t carry = 1;
  for (int i = 2; i >= 0; --i) {
    result.words[i] = ~n.words[i] + carry;
    carry = carry != 0 && result.words[i] == 0 ? 1 : 0;
  }
  return result;
}

WideNumber shifted_left(const WideNumber& n, int by) {
  if (by == 0) return n;
  if (by >= 64) return shifted_left({{n.words[1], n.words[2], 0}}, by - 64);
  return {{n.words[0] << by | n.words[1] >> (64 - by), n.words[1] << by | n.words[2] >> (64 - by),
           n.words[2] << by}};
}

// Returns the number times 2^-192, with a relative error of at most 2^-106.
DoubleDouble fraction(const WideNumber& n) {
  int zeros = 0;
  for (const std::uint64_t word : n.words) {
    zeros += std::countl_zero(word);
    if (word != 0) break;
  }
  if (zeros >= 128) return {0.0, 0.0};  // no double is that close to a multiple of pi / 2
  const WideNumber leading = shifted_left(n, zeros);
  constexpr int kept = 53;
  const auto high = static_cast<double>(leading.words[0] >> (64 - kept));
  const auto low = static_cast<double>(leading.words[0] << kept | leading.words[1] >> (64 - kept));
  return fast_two_sum(high * 0x1p-53 * power_of_two(-zeros), low * 0x1p-117 * power_of_two(-zeros));
}

// Angle as quarter turns and a remainder of at most an eighth turn.
struct Angle {
  unsigned quarters;
  DoubleDouble rest;
};

constexpr double eighth_turn = 0.5 * half_pi.high;

Angle angle(double x) {
  const double a = magnitude(x);
  if (a <= eighth_turn) return {0, {x, 0.0}};
  const std::uint64_t mantissa =
      (to_bits(a) & ((1ULL << mantissa_bits) - 1)) | 1ULL << mantissa_bits;
  const WideNumber turns = quarter_turns(mantissa, binary_exponent(a) - mantissa_bits);
  const WideNumber rest = shifted_left(turns, 2);
  const bool is_next_nearer = rest.words[0] >> 63 != 0;
  const auto quarters = static_cast<unsigned>(turns.words[0] >> 62) + (is_next_nearer ? 1U : 0U);
  DoubleDouble radians = fraction(is_next_nearer ? negated(rest) : rest) * half_pi;
  if (is_next_nearer != (x < 0.0)) radians = -radians;
  return {x < 0.0 ? 4U - quarters : quarters, radians};
}

// Returns 1 / n! for n = first, first + 2, ... with alternating signs.
template <int count>
constexpr std::array<double, count> series(int first) {
  std::array<double, count> coefficients = {};
  double factorial = 1.0;
  for (int n = 2; n <= first; ++n) factorial *= n;
  for (int i = 0, n = first; i < count; ++i, n += 2) {
    coefficients[i] = (i % 2 == 0 ? 1.0 : -1.0) / factorial;
    factorial *= (n + 1) * (n + 2);
  }
  return coefficients;
}
template <std::size_t count>
double sum(const std::array<double, count>& coefficients, double x) {
  double result = coefficients[count - 1];
#pragma GCC unroll 16
  for (std::size_t i = count - 1; i > 0; --i) result = coefficients[i - 1] + x * result;
  return result;
}

// The truncation errors of the series are below 2^-60 of the result.
DoubleDouble reduced_sine(const DoubleDouble& x) {
  static constexpr auto tail = series<8>(3);  // x^3 / 6 - x^5 / 120 + ...
  const double square = x.high * x.high;
  return fast_two_sum(x.high, x.low * (1.0 - 0.5 * square) - x.high * square * sum(tail, square));
}
DoubleDouble reduced_cosine(const DoubleDouble& x) {
  static constexpr auto tail = series<8>(4);  // x^4 / 24 - x^6 / 720 + ...
  const DoubleDouble square = exact_product(x.high, x.high);
  const DoubleDouble start = fast_two_sum(1.0, -0.5 * square.high);
  const double rest = start.low - 0.5 * square.low - x.high * x.low;
  return fast_two_sum(start.high, rest + square.high * square.high * sum(tail, square.high));
}

double nearest(const DoubleDouble& x) { return x.high + x.low; }

// Returns the sine of the angle plus `further_quarters` quarter turns.
double sine(const Angle& of, unsigned further_quarters) {
  const unsigned quarters = of.quarters + further_quarters;
  const double value = nearest(quarters % 2 == 0 ? reduced_sine(of.rest) : reduced_cosine(of.rest));
  return quarters % 4 < 2 ? value : -value;
}

}  // namespace

double sin(double x) {
  if (!is_finite(x)) return not_a_number;
  return magnitude(x) < 0x1p-27 ? x : sine(angle(x), 0);
}

double cos(double x) {
  if (!is_finite(x)) return not_a_number;
  return sine(angle(x), 1);
}

double tan(double x) {
  if (!is_finite(x)) return not_a_number;
  if (magnitude(x) < 0x1p-27) return x;
  const auto [quarters, rest] = angle(x);
  const DoubleDouble sine = reduced_sine(rest), cosine = reduced_cosine(rest);
  return nearest(quarters % 2 == 0 ? sine / cosine : -cosine / sine);
}

}  // namespace skycap::mathematics
