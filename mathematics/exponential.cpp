#include "mathematics/exponential.h"

#include <array>

#include "mathematics/bits.h"
#include "mathematics/elementary.h"

namespace skycap::mathematics {
namespace {

// x = (k / 64) ln 2 + r. e^x is 2^(k / 64) times e^r, with a table for the fractional part of the
// exponent.
constexpr int steps = 64;

constexpr auto fractional_powers = [] {
  std::array<DoubleDouble, steps> powers = {};
  for (int step = 0; step < steps; ++step) {
    const DoubleDouble x = ln_2 * DoubleDouble{static_cast<double>(step) / steps, 0.0};
    DoubleDouble sum = {1.0, 0.0};
    for (int n = 28; n > 0; --n) {
      sum = DoubleDouble{1.0, 0.0} + sum * x / DoubleDouble{static_cast<double>(n), 0.0};
    }
    powers[step] = sum;
  }
  return powers;
}();

// 2^(k / 64) e^r for |r| < ln 2 / 128: 2^exponent * power of the table * (1 + rest).
struct Exponential {
  int exponent;
  DoubleDouble power;
  double rest;
};

// Returns e^r - 1 by its series, with a truncation error below 2^-68 of the result.
double small_expm1(double r) {
  const double tail = 1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r / 5040.0));
  return r + r * r * (0.5 + r * (1.0 / 6.0 + r * tail));
}

Exponential split(int k, double r) {
  return {k >> 6, fractional_powers[k & (steps - 1)], small_expm1(r)};
}

Exponential exponential(const DoubleDouble& x) {
  // ln 2 / 64. The first part has 32 bits, so that its product with k is exact.
  constexpr DoubleDouble step = {0x1.62e42feep-7, 0x1.a39ef35793c76p-39};
  const double k = rounded(x.high * (steps * inverse_ln_2.high));
  const double r = ((x.high - k * step.high) - k * step.low) + x.low;
  return split(static_cast<int>(k), r);
}

double value(const Exponential& of) {
  const auto& [exponent, power, rest] = of;
  return scaled(power.high + (power.low + power.high * rest), exponent);
}

constexpr double max_exponent = 710.0;  // e^710 and e^-746 are out of range
constexpr double min_exponent = -746.0;

}  // namespace

double exp(const DoubleDouble& x) { return value(exponential(x)); }

double exp(double x) {
  if (is_nan(x)) return x;
  if (x > max_exponent) return infinity;
  if (x < min_exponent) return 0.0;
  return exp(DoubleDouble{x, 0.0});
}

double exp2(double x) {
  if (is_nan(x)) return x;
  if (x >= 1024.0) return infinity;
  if (x < -1080.0) return 0.0;
  const double k = rounded(x * steps);
  const double rest = x - k / steps;  // exact
  return value(split(static_cast<int>(k), rest * ln_2.high + rest * ln_2.low));
}

double expm1(double x) {
  if (is_nan(x) || x == 0.0) return x;
  if (x > max_exponent) return infinity;
  if (x < -40.0) return -1.0;
  const auto [exponent, power, rest] = exponential({x, 0.0});
  const double tail = power.low + power.high * rest;
  if (exponent > 60) return scaled(power.high + tail, exponent);
  const double scale = power_of_two(exponent);
  const DoubleDouble whole = exact_sum(scale * power.high, -1.0);
  return whole.high + (whole.low + scale * tail);
}

double sinh(double x) {
  if (is_nan(x) || x == 0.0 || !is_finite(x)) return x;
  const double a = magnitude(x);
  if (a > 40.0) {  // e^-x is less than half an ulp of e^x
    return copy_sign(a > 711.0 ? infinity : 0.5 * exp(0.5 * a) * exp(0.5 * a), x);
  }
  const double less_one = expm1(a);
  return copy_sign(0.5 * (less_one + less_one / (less_one + 1.0)), x);
}

double cosh(double x) {
  const double a = magnitude(x);
  if (a > 40.0) return a > 711.0 ? infinity : 0.5 * exp(0.5 * a) * exp(0.5 * a);
  const double power = exp(a);
  return 0.5 * (power + 1.0 / power);
}

double tanh(double x) {
  if (is_nan(x) || x == 0.0) return x;
  const double a = magnitude(x);
  if (a > 20.0) return copy_sign(1.0, x);
  const double less_one = expm1(2.0 * a);
  return copy_sign(less_one / (less_one + 2.0), x);
}

}  // namespace skycap::mathematics
