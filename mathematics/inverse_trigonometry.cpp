#include <array>

#include "mathematics/bits.h"
#include "mathematics/double_double.h"
#include "mathematics/elementary.h"

namespace skycap::mathematics {
namespace {

// atan(y / x) for 0 <= y <= x: the angle of a table step c = n / 16 near y / x, plus the remaining
// angle.
constexpr int steps = 16;

// Euler's series, whose terms decrease by at least half. With q = c^2 / (1 + c^2), atan(c) is q / c
// times 1 + 2/3 q (1 + 4/5 q (1 + ...)).
constexpr auto step_angles = [] {
  std::array<DoubleDouble, steps + 1> angles = {};
  for (int step = 1; step <= steps; ++step) {
    const DoubleDouble c = {static_cast<double>(step) / steps, 0.0}, one = {1.0, 0.0};
    const DoubleDouble q = c * c / (one + c * c);
    DoubleDouble sum = one;
    for (int n = 110; n > 0; --n) {
      sum = one + sum * q * DoubleDouble{2.0 * n, 0.0} / DoubleDouble{2.0 * n + 1.0, 0.0};
    }
    angles[step] = q / c * sum;
  }
  return angles;
}();

// Returns atan(t) - t for |t| < 1/30, with a truncation error below 2^-64 of t.
double atan_tail(double t) {
  const double square = t * t;
  const double tail = 1.0 / 9.0 - square * (1.0 / 11.0 - square / 13.0);
  return -t * square * (1.0 / 3.0 - square * (1.0 / 5.0 - square * (1.0 / 7.0 - square * tail)));
}

DoubleDouble atan_ratio(const DoubleDouble& y, const DoubleDouble& x) {
  const int step = static_cast<int>(y.high / x.high * steps + 0.5);
  const double c = static_cast<double>(step) / steps;
  DoubleDouble above = y, below = x;
  if (step > 0) {
    above = y - x * DoubleDouble{c, 0.0};
    below = x + y * DoubleDouble{c, 0.0};
  }
  const DoubleDouble t = above / below;
  const DoubleDouble angle = exact_sum(step_angles[step].high, t.high);
  const double rest = step_angles[step].low + (t.low + atan_tail(t.high));
  return fast_two_sum(angle.high, angle.low + rest);
}

// Returns the angle for y >= 0 and any x. Requires that not both are zero, both are finite, and
// their squares neither overflow nor underflow.
double angle_above_axis(const DoubleDouble& y, const DoubleDouble& x) {
  const bool is_negative_half = x.high < 0.0;
  const DoubleDouble across = is_negative_half ? -x : x;
  DoubleDouble angle =
      y.high <= across.high ? atan_ratio(y, across) : half_pi - atan_ratio(across, y);
  if (is_negative_half) angle = pi - angle;
  return angle.high + angle.low;
}

// Returns the square root of 1 - x^2 for |x| <= 1.
DoubleDouble complement(double x) {
  const DoubleDouble square = exact_product(x, x);
  const DoubleDouble rest = DoubleDouble{1.0, 0.0} - square;
  if (rest.high <= 0.0) return {0.0, 0.0};
  const double root = __builtin_sqrt(rest.high);
  const DoubleDouble error = rest - exact_product(root, root);
  return fast_two_sum(root, error.high / (2.0 * root));
}

// Returns the angle of a direction along an axis or with an infinite coordinate.
double special_angle(double y, double x) {
  if (is_nan(x) || is_nan(y)) return x + y;
  const bool is_negative_half = is_negative(x);
  if (!is_finite(x) && !is_finite(y)) {
    return copy_sign((is_negative_half ? 1.5 : 0.5) * half_pi.high, y);
  }
  if (y == 0.0 || !is_finite(x)) return copy_sign(is_negative_half ? pi.high : 0.0, y);
  return copy_sign(half_pi.high, y);
}

}  // namespace

double atan2(double y, double x) {
  if (!is_finite(x) || !is_finite(y) || x == 0.0 || y == 0.0) return special_angle(y, x);
  const double a = magnitude(y), b = magnitude(x);
  if (x > 0.0 && a / b < 0x1p-100) return y / x;
  // Scales the arguments away from the limits of the range, where products would overflow or
  // underflow.
  const double greater = a > b ? a : b;
  const int up = greater < 0x1p-900 ? 200 : 0;
  const int shift = up - binary_exponent(scaled(greater, up));
  return copy_sign(angle_above_axis({scaled(a, shift), 0.0}, {scaled(x, shift), 0.0}), y);
}

double atan(double x) {
  if (is_nan(x) || magnitude(x) < 0x1p-27) return x;
  if (magnitude(x) > 0x1p60) return copy_sign(half_pi.high, x);
  return copy_sign(angle_above_axis({magnitude(x), 0.0}, {1.0, 0.0}), x);
}

double asin(double x) {
  if (is_nan(x) || magnitude(x) < 0x1p-27) return x;
  if (magnitude(x) > 1.0) return not_a_number;
  return copy_sign(angle_above_axis({magnitude(x), 0.0}, complement(x)), x);
}

double acos(double x) {
  if (is_nan(x)) return x;
  if (magnitude(x) > 1.0) return not_a_number;
  return angle_above_axis(complement(x), {x, 0.0});
}

}  // namespace skycap::mathematics
