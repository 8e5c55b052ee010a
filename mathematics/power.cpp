#include "mathematics/bits.h"
#include "mathematics/elementary.h"
#include "mathematics/exponential.h"

namespace skycap::mathematics {
namespace {

bool is_whole(double y) {
  const double a = magnitude(y);
  return a >= 0x1p52 || static_cast<double>(static_cast<std::uint64_t>(a)) == a;
}
bool is_odd(double y) {
  const double a = magnitude(y);
  return a < 0x1p53 && is_whole(y) && static_cast<std::uint64_t>(a) % 2 == 1;
}

// Returns the power for arguments that are NaN, infinite or zero (C standard, annex F, F.10.4.4).
double special_power(double x, double y) {
  if (is_nan(x) || is_nan(y)) return x + y;
  if (!is_finite(y)) {
    if (magnitude(x) == 1.0) return 1.0;
    return (magnitude(x) > 1.0) == (y > 0.0) ? infinity : 0.0;
  }
  const bool grows = (magnitude(x) == infinity) == (y > 0.0);
  const double limit = grows ? infinity : 0.0;
  return is_odd(y) ? copy_sign(limit, x) : limit;
}

// Requires a positive x, and that both are finite.
double pow_positive(double x, double y) {
  // Beyond the bound, x^y is out of range unless x is 1, and the product would not be exact.
  const double bounded = magnitude(y) < 0x1p65 ? y : copy_sign(0x1p65, y);
  const DoubleDouble log = log_positive(x);
  const DoubleDouble product = exact_product(bounded, log.high);
  if (product.high > 710.0) return infinity;
  if (product.high < -746.0) return 0.0;
  return exp(DoubleDouble{product.high, product.low + bounded * log.low});
}

}  // namespace

double pow(double x, double y) {
  if (y == 0.0 || x == 1.0) return 1.0;
  if (!is_finite(x) || !is_finite(y) || x == 0.0) return special_power(x, y);
  if (x > 0.0) return pow_positive(x, y);
  if (!is_whole(y)) return not_a_number;
  const double power = pow_positive(-x, y);
  return is_odd(y) ? -power : power;
}

}  // namespace skycap::mathematics
