#include "missions/package/holes.h"

#include <numbers>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::missions::package {
namespace {

using survey::surfel::EstimatedPatch;
using survey::surfel::MissingReason;

/// Returns a floor of unit patches with holes where find_reason(x, y) gives a reason.
std::vector<EstimatedPatch> make_floor(int size, const auto& find_reason) {
  std::vector<EstimatedPatch> patches;
  for (int x = 0; x < size; ++x) {
    for (int y = 0; y < size; ++y) {
      const MissingReason reason = find_reason(x, y);
      const float covered = reason == MissingReason::none ? 1.0F : 0.0F;
      patches.push_back({Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0.0F),
                         Eigen::Vector3f::UnitZ(), 1.0F, covered, reason});
    }
  }
  return patches;
}

MissingReason two_holes(int x, int y) {
  if (x < 4 && y < 4) return MissingReason::never_seen;       // 16 m^2 around (1.5, 1.5)
  if (x >= 14 && y >= 17) return MissingReason::unreachable;  // 6 x 3
  return x == 10 && y == 10 ? MissingReason::seen_too_thinly : MissingReason::none;
}

TEST(Holes, AreConnectedAndSortedByArea) {
  const std::vector<geometry::View> views = {{{19.0, 19.0, 5.0}, {0, 0, -1}},
                                             {{1.5, 1.5, 4.0}, {0, 0, -1}}};
  const MissingSurface missing = missing_surface(make_floor(20, two_holes), views);
  EXPECT_DOUBLE_EQ(missing.area, 400.0);
  ASSERT_EQ(missing.holes.size(), 2U);
  EXPECT_EQ(missing.holes[0].reason, MissingReason::unreachable);
  EXPECT_DOUBLE_EQ(missing.holes[0].area, 18.0);
  EXPECT_EQ(missing.holes[0].nearest_view, 0U);
  EXPECT_EQ(missing.holes[1].reason, MissingReason::never_seen);
  EXPECT_DOUBLE_EQ(missing.holes[1].area, 16.0);
  EXPECT_EQ(missing.holes[1].centre, Eigen::Vector3d(1.5, 1.5, 0.0));
  EXPECT_EQ(missing.holes[1].normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(missing.holes[1].nearest_view, 1U);
  EXPECT_DOUBLE_EQ(missing.holes[1].view_distance, 4.0);
  EXPECT_EQ(missing.smaller, 1U);
  EXPECT_DOUBLE_EQ(missing.smaller_area, 1.0);
}

// Adjacent patches with different reasons form separate holes.
TEST(Holes, AreSplitByReason) {
  const MissingSurface missing = missing_surface(
      make_floor(10,
                 [](int x, int) {
                   return x < 5 ? MissingReason::never_seen : MissingReason::unreachable;
                 }),
      {});
  ASSERT_EQ(missing.holes.size(), 2U);
  EXPECT_DOUBLE_EQ(missing.holes[0].area, 50.0);
  EXPECT_NE(missing.holes[0].reason, missing.holes[1].reason);
}

// Predicted patches of 4 m at a distance of 5 m form one hole. Patches of 0.5 m at a distance of 2
// m are separate holes. Most patches have a side of 1 m.
TEST(Holes, LinkPatchesByPatchSize) {
  std::vector<EstimatedPatch> patches =
      make_floor(20, [](int, int) { return MissingReason::none; });
  for (int i = 0; i < 4; ++i) {
    const auto step = static_cast<float>(i);
    patches.push_back({{5.0F * step, 0.0F, 50.0F},
                       Eigen::Vector3f::UnitZ(),
                       16.0F,
                       0.0F,
                       MissingReason::never_seen});
    patches.push_back({{2.0F * step, 0.0F, 90.0F},
                       Eigen::Vector3f::UnitZ(),
                       0.25F,
                       0.0F,
                       MissingReason::never_seen});
  }
  const MissingSurface missing = missing_surface(patches, {});
  ASSERT_EQ(missing.holes.size(), 1U);
  EXPECT_DOUBLE_EQ(missing.holes[0].area, 64.0);
  EXPECT_EQ(missing.smaller, 4U);
  EXPECT_DOUBLE_EQ(missing.smaller_area, 1.0);
}

// For any patches, the missing area is neither lost nor counted twice.
TEST(Holes, SumToMissingArea) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> coordinate(0.0F, 20.0F), share(0.0F, 1.0F);
  std::vector<EstimatedPatch> patches;
  double area = 0.0, covered = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const auto reason = static_cast<MissingReason>(i % 4);
    const float size = 0.1F + share(random), part = share(random);
    patches.push_back({{coordinate(random), coordinate(random), coordinate(random)},
                       Eigen::Vector3f::UnitX(),
                       size,
                       part,
                       reason});
    area += size;
    covered += size * part;
  }
  const MissingSurface missing = missing_surface(patches, {});
  double sum = missing.smaller_area + missing.rest;
  for (const Hole& hole : missing.holes) sum += hole.area;
  EXPECT_NEAR(missing.area, area, 1e-9 * area);
  EXPECT_NEAR(sum, area - covered, 1e-6 * area);  // products of floats
}

TEST(Holes, AreEmptyWithoutMissingSurface) {
  const MissingSurface missing = missing_surface({}, {});
  EXPECT_TRUE(missing.holes.empty());
  EXPECT_EQ(missing.area, 0.0);
  EXPECT_EQ(missing_surface(make_floor(5, [](int, int) { return MissingReason::none; }), {}).rest,
            0.0);
}

TEST(TruePatches, HaveSamplesWithEqualAreas) {
  geometry::SurfaceSamples samples;
  samples.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  samples.normals.assign(4, Eigen::Vector3f::UnitZ());
  const std::vector<std::uint8_t> is_covered = {1, 0, 0, 1}, is_visible = {1, 1, 0, 1};
  const auto patches = true_patches(samples, 8.0, is_covered, is_visible);
  ASSERT_EQ(patches.size(), 4U);
  EXPECT_EQ(patches[0].area, 2.0F);
  EXPECT_EQ(patches[0].reason, MissingReason::none);
  EXPECT_EQ(patches[1].reason, MissingReason::never_seen);
  EXPECT_EQ(patches[2].reason, MissingReason::unreachable);
  // Half of the surface is missing, both in the estimate and in the ground truth.
  EXPECT_DOUBLE_EQ(missing_surface(patches, {}).area, 8.0);
  EXPECT_EQ(true_patches(samples, 8.0, is_covered, {})[2].reason, MissingReason::never_seen);
}

}  // namespace
}  // namespace skycap::missions::package
