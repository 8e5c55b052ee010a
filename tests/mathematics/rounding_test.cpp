/// Operations that the compiler must not change, because results have to be identical on all
/// platforms.
#include <array>

#include <gtest/gtest.h>

namespace skycap::mathematics {
namespace {

struct Rounded {
  std::array<float, 2> narrow;
  std::array<double, 2> wide;
};

/// Rounds as points are stored and used immediately afterwards. Vectorisers tend to merge such a
/// block.
[[gnu::noinline]] void round(const std::array<double, 2>& given, Rounded& rounded) {
  const auto x = static_cast<float>(given[0]);
  const auto y = static_cast<float>(given[1]);
  rounded.narrow[0] = x;
  rounded.narrow[1] = y;
  rounded.wide[0] = x;
  rounded.wide[1] = y;
}

TEST(Rounding, KeepsSinglePrecisionAfterWidening) {
  Rounded rounded{};
  round({0.1, 0.2}, rounded);
  EXPECT_EQ(rounded.wide[0], 0.1F);
  EXPECT_EQ(rounded.wide[1], 0.2F);
  EXPECT_NE(rounded.wide[0], 0.1);
}

}  // namespace
}  // namespace skycap::mathematics
