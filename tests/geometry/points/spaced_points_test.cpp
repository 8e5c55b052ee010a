#include "geometry/points/spaced_points.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/clouds.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3f;
using tests::random_points;

// Brute-force twin: what is kept is what comparing with every point kept before would keep,
// whatever the width of the cells.
TEST(SpacedPoints, KeepsWhatAComparisonWithAllOfThemWouldKeep) {
  constexpr double spacing = 0.07;
  const std::vector<Vector3f> points = random_points(5'000, 0.3, 5);
  std::vector<Vector3f> expected;
  for (const Vector3f& p : points) {
    bool has_room = true;
    for (const Vector3f& other : expected) {
      has_room = has_room && squared_distance(p, other) > static_cast<float>(spacing * spacing);
    }
    if (has_room) expected.push_back(p);
  }
  ASSERT_GT(expected.size(), 100U);
  ASSERT_LT(expected.size(), points.size());
  for (const double cell_size : {spacing, 2.0 * spacing, 0.5}) {
    SpacedPoints kept(spacing, cell_size);
    std::size_t count = 0;
    for (const Vector3f& p : points) count += kept.keep(p) ? 1 : 0;
    ASSERT_EQ(count, expected.size());
    ASSERT_EQ(kept.grid().size(), expected.size());
    for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(kept.grid().point(i), expected[i]);
  }
}

}  // namespace
}  // namespace skycap::geometry
