#include <array>

#include "mathematics/bits.h"
#include "mathematics/elementary.h"
#include "mathematics/exponential.h"

namespace skycap::mathematics {
namespace {

// x = 2^e m, with m in [1, 2), or in [0.7, 1) from the step on whose end exceeds the square root of
// 2. Multiplication by a short factor close to 1 / m brings m near 1; the logarithm of the factor
// is in a table.
constexpr int steps = 128;
constexpr int first_halved = 53;

struct Step {
  double factor;
  DoubleDouble log;  // logarithm of 1 / factor
};

// log((1 + z) / (1 - z)) = 2 (z + z^3 / 3 + ...), |z| < 0.2.
constexpr DoubleDouble log_ratio(const DoubleDouble& z) {
  const DoubleDouble square = z * z;
  DoubleDouble sum = {0.0, 0.0};
  for (int n = 45; n > 0; n -= 2) {
    sum = sum * square + DoubleDouble{1.0, 0.0} / DoubleDouble{static_cast<double>(n), 0.0};
  }
  return DoubleDouble{2.0, 0.0} * z * sum;
}

constexpr auto table = [] {
  std::array<Step, steps> made = {};
  for (int step = 0; step < steps; ++step) {
    const double middle = (1.0 + (step + 0.5) / steps) * (step >= first_halved ? 0.5 : 1.0);
    const bool is_next_to_one = step == 0 || step == steps - 1;
    const double factor = is_next_to_one ? 1.0 : rounded(512.0 / middle) / 512.0;
    made[step] = {factor,
                  log_ratio(DoubleDouble{1.0 - factor, 0.0} / DoubleDouble{1.0 + factor, 0.0})};
  }
  return made;
}();

// 1 / 3, -1 / 4, ...; the truncation error is below 2^-66 of r.
constexpr auto log_tail = [] {
  std::array<double, 9> coefficients = {};
  for (int i = 0; i < 9; ++i) coefficients[i] = (i % 2 == 0 ? 1.0 : -1.0) / (i + 3);
  return coefficients;
}();

// Returns log(1 + r) for |r| < 2^-6.5.
DoubleDouble log_near_one(const DoubleDouble& r) {
  const DoubleDouble square = exact_product(r.high, r.high);
  double tail = 0.0;
#pragma GCC unroll 16
  for (std::size_t i = log_tail.size(); i > 0; --i) tail = log_tail[i - 1] + r.high * tail;
  const DoubleDouble sum = fast_two_sum(r.high, -0.5 * square.high);
  const double rest = (r.low - r.high * r.low) - 0.5 * square.low + r.high * square.high * tail;
  return fast_two_sum(sum.high, sum.low + rest);
}

struct NormalNumber {
  int exponent;
  double mantissa;  // in [1, 2)
};
NormalNumber normal_number(double x) {
  constexpr int up = 54;  // exponent shift of subnormal numbers
  const bool is_subnormal = x < 0x1p-1022;
  const double normal = is_subnormal ? x * 0x1p54 : x;
  const std::uint64_t mantissa = to_bits(normal) & ((1ULL << mantissa_bits) - 1);
  return {binary_exponent(normal) - (is_subnormal ? up : 0),
          std::bit_cast<double>(mantissa | to_bits(1.0))};
}

// Returns whether special_log() applies: zero, negative and non-finite numbers.
bool is_special(double x) { return !(x > 0.0 && x < infinity); }
double special_log(double x) {
  if (x == 0.0) return -infinity;
  return x < 0.0 ? not_a_number : x;
}

double log_times(double x, const DoubleDouble& factor) {
  if (is_special(x)) return special_log(x);
  const DoubleDouble log = log_positive(x);
  const DoubleDouble product = exact_product(log.high, factor.high);
  return product.high + (product.low + (log.high * factor.low + log.low * factor.high));
}

}  // namespace

DoubleDouble log_positive(double x) {
  auto [exponent, mantissa] = normal_number(x);
  const auto step = static_cast<int>((mantissa - 1.0) * steps);
  if (step >= first_halved) {
    ++exponent;
    mantissa *= 0.5;
  }
  const auto& [factor, step_log] = table[step];
  const double mantissa_high =
      (mantissa + 0x1p12) - 0x1p12;  // 40 bits; its product with the factor is exact
  const DoubleDouble r =
      fast_two_sum(mantissa_high * factor - 1.0, (mantissa - mantissa_high) * factor);
  const DoubleDouble near_one = log_near_one(r);
  if (exponent == 0 && factor == 1.0) return near_one;
  constexpr DoubleDouble ln_2_in_parts = {0x1.62e42fefa38p-1, 0x1.ef35793c7673p-45};  // 42 bits
  const auto e = static_cast<double>(exponent);
  const DoubleDouble whole = exact_sum(e * ln_2_in_parts.high, step_log.high);
  const DoubleDouble all = exact_sum(whole.high, near_one.high);
  return fast_two_sum(
      all.high, all.low + (whole.low + (e * ln_2_in_parts.low + (step_log.low + near_one.low))));
}

double log(double x) {
  if (is_special(x)) return special_log(x);
  const DoubleDouble log = log_positive(x);
  return log.high + log.low;
}
double log2(double x) { return log_times(x, inverse_ln_2); }
double log10(double x) { return log_times(x, inverse_ln_10); }

double log1p(double x) {
  if (is_nan(x) || x == 0.0 || x == infinity) return x;
  if (x <= -1.0) return x == -1.0 ? -infinity : not_a_number;
  if (magnitude(x) < 0x1p-7) {
    const DoubleDouble log = log_near_one({x, 0.0});
    return log.high + log.low;
  }
  const DoubleDouble sum = exact_sum(1.0, x);
  const DoubleDouble log = log_positive(sum.high);
  return log.high + (log.low + sum.low / sum.high);
}

double asinh(double x) {
  if (is_nan(x) || !is_finite(x)) return x;
  const double a = magnitude(x);
  if (a < 0x1p-28) return x;
  if (a > 0x1p28) return copy_sign(log(a) + ln_2.high, x);
  const double square = a * a;
  return copy_sign(log1p(a + square / (1.0 + __builtin_sqrt(square + 1.0))), x);
}

double acosh(double x) {
  if (is_nan(x) || x == infinity) return x;
  if (x < 1.0) return not_a_number;
  if (x > 0x1p28) return log(x) + ln_2.high;
  const double above = x - 1.0;
  return log1p(above + __builtin_sqrt(2.0 * above + above * above));
}

double atanh(double x) {
  const double a = magnitude(x);
  if (is_nan(x) || a < 0x1p-28) return x;
  if (a >= 1.0) return a == 1.0 ? copy_sign(infinity, x) : not_a_number;
  return copy_sign(0.5 * log1p(2.0 * a / (1.0 - a)), x);
}

}  // namespace skycap::mathematics
