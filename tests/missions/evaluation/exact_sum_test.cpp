#include "missions/evaluation/exact_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace skycap::missions {
namespace {

/// Returns random numbers with magnitudes from 2^-60 to 2^60.
std::vector<double> numbers(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(1.0, 2.0);
  std::uniform_int_distribution<int> exponent(-60, 60);
  std::vector<double> all;
  for (std::size_t i = 0; i < count; ++i) {
    const double number = mantissa(random);
    all.push_back(std::ldexp(number, exponent(random)));
  }
  return all;
}

evaluation::ExactSum compute_sum(const std::vector<double>& all) {
  evaluation::ExactSum sum;
  for (const double number : all) sum.add(number);
  return sum;
}

TEST(ExactSum, KeepsSmallTerms) {
  // 2^70 + 2^-70, three times: double precision would lose the small terms.
  evaluation::ExactSum sum;
  for (int i = 0; i < 3; ++i) {
    sum.add(std::ldexp(1.0, 70));
    sum.add(std::ldexp(1.0, -70));
  }
  EXPECT_EQ(sum.value(), 3.0 * std::ldexp(1.0, 70));
  evaluation::ExactSum small;
  for (int i = 0; i < 1 << 20; ++i) small.add(std::ldexp(1.0, -70));
  evaluation::ExactSum one;
  one.add(1.0);
  one.add(small);
  EXPECT_EQ(one.value(), 1.0 + std::ldexp(1.0, -50));
  EXPECT_EQ(evaluation::ExactSum().value(), 0.0);
}

// Property: the digits do not depend on order or partition.
TEST(ExactSum, IsIndependentOfOrderAndPartition) {
  std::vector<double> all = numbers(10'000);
  const evaluation::ExactSum::Digits digits = compute_sum(all).all_digits();
  std::shuffle(all.begin(), all.end(), std::mt19937_64(2));
  EXPECT_EQ(compute_sum(all).all_digits(), digits);
  evaluation::ExactSum parts_sum;
  for (std::size_t first = 0; first < all.size(); first += 1234) {
    const std::size_t end = std::min(all.size(), first + 1234);
    const auto part = compute_sum({all.begin() + static_cast<std::ptrdiff_t>(first),
                                   all.begin() + static_cast<std::ptrdiff_t>(end)});
    parts_sum.add(evaluation::ExactSum(part.all_digits()));
  }
  EXPECT_EQ(parts_sum.all_digits(), digits);
  long double reference = 0.0L;
  std::ranges::sort(all);
  for (const double number : all) reference += static_cast<long double>(number);
  EXPECT_NEAR(parts_sum.value(), static_cast<double>(reference),
              1e-13 * static_cast<double>(reference));
}

TEST(ExactSum, RepresentsExtremeDoubles) {
  evaluation::ExactSum sum;
  sum.add(std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(sum.value(), std::numeric_limits<double>::denorm_min());
  sum.add(std::numeric_limits<double>::max());
  EXPECT_EQ(sum.value(), std::numeric_limits<double>::max());
}

}  // namespace
}  // namespace skycap::missions
