#include "geometry/pose/space_curve.h"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

TEST(SpaceCurve, VisitsCellsOctantByOctant) {
  const CurveGrid grid{Eigen::Vector3d::Zero(), 1.0};
  EXPECT_EQ(grid.key({0.5F, 0.5F, 0.5F}), 0U);
  EXPECT_EQ(grid.key({1.5F, 0.5F, 0.5F}), 1U);
  EXPECT_EQ(grid.key({0.5F, 1.5F, 0.5F}), 2U);
  EXPECT_EQ(grid.key({0.5F, 0.5F, 1.5F}), 4U);
  EXPECT_EQ(grid.key({2.5F, 3.5F, 0.5F}), 8U + 16U + 2U);
}

// Property: each point occurs once, keys are ascending, and equal keys keep their order.
TEST(SpaceCurve, SortsPointsByKeyAndIndex) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> coordinate(0, 40);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3i cell{coordinate(random), coordinate(random), coordinate(random)};
    points.push_back(cell.cast<float>());
  }
  const std::vector<CurveEntry> entries = along_curve(points, {{1, 1, 1}, 4.0});
  const auto before = [](const CurveEntry& a, const CurveEntry& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  };
  EXPECT_TRUE(std::ranges::is_sorted(entries, before));
  std::vector<bool> is_there(points.size());
  for (const CurveEntry& entry : entries) is_there[entry.index] = true;
  EXPECT_EQ(std::ranges::count(is_there, true), 5000);
}

TEST(SpaceCurve, AcceptsNanAndInfiniteCoordinates) {
  constexpr float infinity = std::numeric_limits<float>::infinity(),
                  none = std::numeric_limits<float>::quiet_NaN();
  const CurveGrid grid{Eigen::Vector3d::Zero(), 1.0};
  EXPECT_EQ(grid.key({none, -infinity, 1.0F}), 4U);
  EXPECT_EQ(grid.key({infinity, 0.0F, 0.0F}), grid.key({65535.0F, 0.0F, 0.0F}));
}

}  // namespace
}  // namespace skycap::geometry
