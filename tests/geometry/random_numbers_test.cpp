#include "geometry/random_numbers.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

std::vector<double> draw_normals(RandomNumbers random, int count) {
  std::vector<double> numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(random.normal());
  return numbers;
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

// The standard error of each mean is 0.003 or less.
TEST(RandomNumbers, DrawsIndependentStandardNormals) {
  constexpr int count = 100'000;
  const std::vector<double> all = draw_normals(RandomNumbers(7), 2 * count);
  std::vector<double> even, odd;  // The transform makes both of a pair from the same bits.
  for (std::size_t i = 0; i < all.size(); i += 2) {
    even.push_back(all[i]);
    odd.push_back(all[i + 1]);
  }
  const std::vector<double> ones(count, 1.0);
  for (const std::vector<double>& numbers : {even, odd}) {
    EXPECT_NEAR(mean_product(numbers, ones), 0.0, 0.02);
    EXPECT_NEAR(mean_product(numbers, numbers), 1.0, 0.03);
  }
  EXPECT_NEAR(mean_product(even, odd), 0.0, 0.02);
  int within = 0;
  for (const double number : all) within += std::abs(number) < 1.0 ? 1 : 0;
  EXPECT_NEAR(within / (2.0 * count), std::erf(std::sqrt(0.5)), 0.005);
}

TEST(RandomNumbers, DrawsIndependentSequencesForSeedsAndStreams) {
  constexpr int count = 10'000;
  const std::array sequences{draw_normals(RandomNumbers(7, 0), count),
                             draw_normals(RandomNumbers(7, 1), count),
                             draw_normals(RandomNumbers(8, 0), count)};
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_NEAR(mean_product(sequences[i], sequences[j]), 0.0, 0.05);
    }
  }
}

TEST(RandomNumbers, RepeatsSequenceOfSeed) {
  EXPECT_EQ(draw_normals(RandomNumbers(7, 3), 100), draw_normals(RandomNumbers(7, 3), 100));
}

}  // namespace
}  // namespace skycap::geometry
