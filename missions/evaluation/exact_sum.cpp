#include "missions/evaluation/exact_sum.h"

#include <bit>
#include <cmath>

namespace skycap::missions::evaluation {
namespace {

constexpr int min_exponent = -1074;
constexpr std::uint64_t low = 0xFFFFFFFFU;

}  // namespace

void ExactSum::carry(Digits& sum) {
  for (std::size_t i = 0; i + 1 < digits; ++i) {
    sum[i + 1] += sum[i] >> 32;
    sum[i] &= low;
  }
}

void ExactSum::add(double number) {
  constexpr std::uint64_t fraction = (std::uint64_t{1} << 52) - 1;
  const auto bits = std::bit_cast<std::uint64_t>(number);
  const std::uint64_t exponent = bits >> 52;  // the sign bit is zero
  const std::uint64_t mantissa = (bits & fraction) | (exponent == 0 ? 0 : fraction + 1);
  // Bit position above the minimum exponent.
  const std::uint64_t bit = exponent == 0 ? 0 : exponent - 1;
  std::uint64_t* const to = digits_.data() + bit / 32;
  const std::uint64_t lower = (mantissa & low) << bit % 32;
  const std::uint64_t upper = (mantissa >> 32) << bit % 32;
  to[0] += lower & low;
  to[1] += (lower >> 32) + (upper & low);
  to[2] += upper >> 32;
  if (++pending_additions_ < 1U << 30) return;
  carry(digits_);
  pending_additions_ = 0;
}

void ExactSum::add(const ExactSum& more) {
  const Digits theirs = more.all_digits();
  carry(digits_);
  pending_additions_ = 0;
  for (std::size_t i = 0; i < digits; ++i) digits_[i] += theirs[i];
}

double ExactSum::value() const {
  const Digits sum = all_digits();
  double value = 0.0;  // adding digits by increasing weight minimises the rounding error
  for (std::size_t i = 0; i < digits; ++i) {
    const int exponent = min_exponent + 32 * static_cast<int>(i);
    value += std::ldexp(static_cast<double>(sum[i]), exponent);
  }
  return value;
}

ExactSum::Digits ExactSum::all_digits() const {
  Digits sum = digits_;
  carry(sum);
  return sum;
}

}  // namespace skycap::missions::evaluation
