#include "geometry/points/spaced_points.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/clouds.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3f;
using tests::random_points;

// Brute-force reference: the kept points equal those of a comparison with all previously kept
// points, for any cell width.
TEST(SpacedPoints, MatchesComparisonWithAllPoints) {
  constexpr double spacing = 0.07;
  const std::vector<Vector3f> points = random_points(5'000, 0.3, 5);
  std::vector<Vector3f> expected;
  for (const Vector3f& p : points) {
    bool is_spaced = true;
    for (const Vector3f& other : expected) {
      is_spaced = is_spaced && squared_distance(p, other) > static_cast<float>(spacing * spacing);
    }
    if (is_spaced) expected.push_back(p);
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

/// Returns the kept points of scans that are inserted one after the other in parts. `reported`
/// receives the reported points.
std::vector<Vector3f> filter_scans(const std::vector<std::vector<Vector3f>>& scans,
                                   std::size_t columns, unsigned threads,
                                   std::vector<Vector3f>& reported) {
  constexpr std::size_t part_size = 300;  // more parts than are compared at once
  SpacedPoints kept(0.05);
  for (const std::vector<Vector3f>& scan : scans) {
    kept.keep_all(
        scan, columns, (scan.size() + part_size - 1) / part_size, threads,
        [&](std::size_t part, auto visit) {
          const std::size_t end = std::min(scan.size(), (part + 1) * part_size);
          for (std::size_t i = part * part_size; i < end; ++i) {
            visit(static_cast<std::uint32_t>(i), i % columns);
          }
        },
        [&](std::uint32_t number) { reported.push_back(scan[number]); });
  }
  std::vector<Vector3f> points;
  for (std::uint32_t i = 0; i < kept.grid().size(); ++i) points.push_back(kept.grid().point(i));
  return points;
}

// Columns and threads only change the speed, not the result.
TEST(SpacedPoints, MatchesPointwiseFilterForScans) {
  std::vector<std::vector<Vector3f>> scans = {
      random_points(4'000, 0.3, 1), {}, random_points(5'000, 0.4, 2)};
  scans.push_back(scans.front());  // contains no new points
  std::vector<Vector3f> in_rows;
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 90; ++column) {
      if ((row * column) % 7 == 3) continue;  // no return
      in_rows.emplace_back(0.01F * static_cast<float>(column), 0.01F * static_cast<float>(row),
                           column < 50 ? 0.5F : 0.55F);
    }
  }
  scans.push_back(in_rows);
  SpacedPoints one_by_one(0.05);
  for (const std::vector<Vector3f>& scan : scans) {
    for (const Vector3f& point : scan) one_by_one.keep(point);
  }
  std::vector<Vector3f> expected;
  for (std::uint32_t i = 0; i < one_by_one.grid().size(); ++i) {
    expected.push_back(one_by_one.grid().point(i));
  }
  ASSERT_GT(expected.size(), 500U);
  for (const unsigned threads : {1U, 2U, 4U}) {
    for (const std::size_t columns : {1U, 2U, 90U}) {
      std::vector<Vector3f> reported;
      EXPECT_EQ(filter_scans(scans, columns, threads, reported), expected);
      EXPECT_EQ(reported, expected);
    }
  }
}

}  // namespace
}  // namespace skycap::geometry
