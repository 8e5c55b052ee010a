#include "mathematics/bits.h"
#include "mathematics/double_double.h"
#include "mathematics/elementary.h"
#include "mathematics/exponential.h"

namespace skycap::mathematics {
namespace {

constexpr DoubleDouble inverse_root_pi = {0x1.20dd750429b6dp-1, 0x1.1ae3a914fed80p-57};

/// Returns e^(-x^2) with an exact x^2.
double gaussian(double x) { return exp(-exact_product(x, x)); }

/// Returns erf(x) for x in (0, 2.5] by its series of positive terms (Abramowitz and Stegun, 7.1.6).
double by_series(double x) {
  const DoubleDouble twice_square = DoubleDouble{2.0, 0.0} * exact_product(x, x);
  DoubleDouble term = {x, 0.0}, sum = term;
  for (double odd = 3.0; term.high > 0x1p-70 * sum.high; odd += 2.0) {
    term = term * twice_square / DoubleDouble{odd, 0.0};
    sum = sum + term;
  }
  const DoubleDouble result = DoubleDouble{2.0, 0.0} * inverse_root_pi * sum;
  return gaussian(x) * result.high + gaussian(x) * result.low;
}

/// Returns 1 - erf(x) for x > 2.5 by its continued fraction (Abramowitz and Stegun, 7.1.14). The
/// result is below 2^-11, so double precision is sufficient for subtracting it from 1.
double rest(double x) {
  double fraction = x;
  for (int n = 48; n > 0; --n) fraction = x + 0.5 * n / fraction;
  return gaussian(x) * inverse_root_pi.high / fraction;
}

}  // namespace

double erf(double x) {
  if (is_nan(x)) return x;
  const double a = magnitude(x);
  if (a > 6.0) return copy_sign(1.0, x);
  if (a > 2.5) return copy_sign(1.0 - rest(a), x);
  // The first term is sufficient for small x, and products of subnormal numbers would lose digits.
  if (a < 0x1p-300) return 2.0 * inverse_root_pi.high * x;
  return copy_sign(by_series(a), x);
}

}  // namespace skycap::mathematics
