#include "flight/district/pad_sorties.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::Each;
using testing::IsEmpty;

struct CapturePoints {
  std::vector<CapturePoint> capture_points;
  std::vector<std::uint32_t> targets;

  /// Adds `count` capture points around a target.
  void add(const Vector3d& middle, int count, std::uint32_t target, std::mt19937_64& random) {
    const Eigen::AlignedBox3d around(middle - Vector3d(15, 15, 5), middle + Vector3d(15, 15, 5));
    for (int i = 0; i < count; ++i) {
      CapturePoint capture_point;
      capture_point.view = {scenes::point_in(random, around), Vector3d::UnitX()};
      capture_points.push_back(capture_point);
      targets.push_back(target);
    }
  }
};

const Motion& motion() {
  static const Motion made(Vehicle{}, Conditions{});
  return made;
}

std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> numbers) {
  std::ranges::sort(numbers);
  return numbers;
}

std::vector<std::uint32_t> numbers_below(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0U);
  return numbers;
}

TEST(PadSorties, ReachEachTargetFromItsNearestPad) {
  std::mt19937_64 random(1);
  CapturePoints given;
  given.add({0, 0, 15}, 8, 0, random);
  given.add({600, 0, 15}, 8, 1, random);
  const std::vector<Vector3d> pads{{620, 20, 0}, {-20, 20, 0}};
  const PadSorties sorties =
      sorties_from_pads(given.capture_points, given.targets, pads, 5.0, motion());
  EXPECT_EQ(sorted(sorties.order), numbers_below(16));
  EXPECT_THAT(sorties.unreachable, IsEmpty());
  ASSERT_EQ(sorties.pads.size(), 16U);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(sorties.pads[i], sorties.order[i] < 8 ? 1U : 0U);
  }
}

TEST(PadSorties, ListCapturePointsOutOfBatteryRangeAsUnreachable) {
  std::mt19937_64 random(2);
  CapturePoints given;
  given.add({0, 0, 15}, 3, 0, random);
  given.add({90'000, 0, 15}, 2, 1, random);
  const std::vector<Vector3d> pads{{20, 20, 0}};
  const PadSorties sorties =
      sorties_from_pads(given.capture_points, given.targets, pads, 5.0, motion());
  EXPECT_EQ(sorted(sorties.unreachable), (std::vector<std::uint32_t>{3, 4}));
  EXPECT_EQ(sorted(sorties.order), numbers_below(3));
  EXPECT_THAT(sorties.pads, Each(0U));
}

// Capture points of neighbouring targets are ordered together, up to a thousand at a time.
TEST(PadSorties, OrderThousandCapturePointsNearTheExpectedTourLength) {
  std::mt19937_64 random(3);
  CapturePoints given;
  for (std::uint32_t target = 0; target < 240; ++target) {
    const std::uint32_t row = target / 16;
    given.add({40.0 * (target % 16), 40.0 * row, 15}, 5, target, random);
  }
  const std::vector<Vector3d> pads{{-30, -30, 0}};
  const PadSorties sorties =
      sorties_from_pads(given.capture_points, given.targets, pads, 5.0, motion());
  EXPECT_EQ(sorted(sorties.order), numbers_below(1200));
  // A tour through many evenly distributed points in an area has the length 0.7124 sqrt(points x
  // area) (Beardwood, Halton & Hammersley 1959). These points are also distributed in height, which
  // makes the tour longer.
  EXPECT_LT(sorties.length, 1.6 * 0.7124 * std::sqrt(1200.0 * 640.0 * 600.0));
}

TEST(PadSorties, AreEmptyWithoutCapturePointsOrPads) {
  EXPECT_THAT(sorties_from_pads({}, {}, std::vector<Vector3d>{{0, 0, 0}}, 5.0, motion()).order,
              IsEmpty());
  std::mt19937_64 random(4);
  CapturePoints given;
  given.add({0, 0, 15}, 2, 0, random);
  EXPECT_THAT(sorties_from_pads(given.capture_points, given.targets, {}, 5.0, motion()).order,
              IsEmpty());
}

}  // namespace
}  // namespace skycap::flight
