/// Double-double arithmetic (numbers as sums of two doubles) without fused multiply-add.
///
/// Source of the error-free sums and products: T. J. Dekker, A floating-point technique for
/// extending the available precision, Numerische Mathematik 18 (1971); D. E. Knuth, The Art of
/// Computer Programming, vol. 2, section 4.2.2.
#pragma once

namespace skycap::mathematics {

/// The number high + low. |low| is at most half an ulp of high, except for rounding errors.
struct DoubleDouble {
  double high, low;
};

/// Returns a + b exactly.
constexpr DoubleDouble exact_sum(double a, double b) {
  const double sum = a + b, b_in_sum = sum - a;
  return {sum, (a - (sum - b_in_sum)) + (b - b_in_sum)};
}

/// Returns a + b exactly. Requires |a| >= |b|, or that one of them is zero.
constexpr DoubleDouble fast_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// Returns a * b exactly. Requires |a|, |b| <= 2^995 and that the product and its error term are in
/// the range of double.
constexpr DoubleDouble exact_product(double a, double b) {
  constexpr double splitter = 0x1p27 + 1.0;
  const double a_scaled = splitter * a, b_scaled = splitter * b;
  const double a_high = a_scaled - (a_scaled - a), b_high = b_scaled - (b_scaled - b);
  const double a_low = a - a_high, b_low = b - b_high;
  const double product = a * b;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

/// Returns the sum with a relative error of about 2^-104, if the summands do not cancel.
constexpr DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
  const DoubleDouble both = fast_two_sum(high.high, high.low + low.high);
  return fast_two_sum(both.high, both.low + low.low);
}
constexpr DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }
constexpr DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }

/// Returns the product with a relative error of about 2^-102.
constexpr DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble product = exact_product(a.high, b.high);
  return fast_two_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}
constexpr DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double high = a.high / b.high;
  const DoubleDouble rest = a - DoubleDouble{high, 0.0} * b;
  const double low = rest.high / b.high;
  const DoubleDouble second_remainder = rest - DoubleDouble{low, 0.0} * b;
  const DoubleDouble quotient = fast_two_sum(high, low);
  return fast_two_sum(quotient.high, quotient.low + second_remainder.high / b.high);
}

inline constexpr DoubleDouble pi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
inline constexpr DoubleDouble half_pi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
inline constexpr DoubleDouble ln_2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
inline constexpr DoubleDouble inverse_ln_2 = {0x1.71547652b82fep+0, 0x1.777d0ffda0d24p-56};
inline constexpr DoubleDouble inverse_ln_10 = {0x1.bcb7b1526e50ep-2, 0x1.95355baaafad3p-57};

}  // namespace skycap::mathematics
