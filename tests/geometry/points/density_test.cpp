#include "geometry/points/density.h"

#include <algorithm>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/clouds.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3f;
using testing::ElementsAre;
using testing::IsEmpty;

/// Computes labels from their definition. Points in `discarded` are never frontiers.
std::vector<PointLabel> labels_by_definition(const std::vector<Vector3f>& points, double radius,
                                             int core_threshold,
                                             const std::set<std::uint32_t>& discarded = {}) {
  const auto near = [&](std::size_t a, std::size_t b) {
    return squared_distance(points[a], points[b]) <= static_cast<float>(radius * radius);
  };
  std::vector<bool> core(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    int count = 0;
    for (std::size_t j = 0; j < points.size(); ++j) count += near(i, j) ? 1 : 0;
    core[i] = count >= core_threshold;
  }
  std::vector<PointLabel> labels(points.size(), PointLabel::core);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (core[i]) continue;
    bool has_core = false, has_other = false;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j || !near(i, j)) continue;
      (core[j] ? has_core : has_other) = true;
    }
    const bool frontier =
        has_core && has_other && !discarded.contains(static_cast<std::uint32_t>(i));
    labels[i] = frontier ? PointLabel::frontier : PointLabel::outlier;
  }
  return labels;
}

std::vector<std::uint32_t> frontiers(const std::vector<PointLabel>& labels) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == PointLabel::frontier) found.push_back(i);
  }
  return found;
}

// Sparse noise around a sphere, in batches. Points become core late, through neighbours of
// neighbours. Runs with one thread and with several.
TEST(DensityMap, MatchesFullRecomputationAfterEveryUpdate) {
  for (const int threshold : {4, 5, 8}) {
    DensityMap map({.radius = 0.12, .core_threshold = threshold, .spacing = 0.02});
    std::vector<std::uint32_t> frontiers_before;
    for (std::uint32_t batch = 0; batch < 8; ++batch) {
      map.insert(tests::noisy_sphere(150, 0.05, batch), batch);
      const DensityUpdate update = map.relabel(threshold == 5 ? 3 : 1);

      const auto expected = labels_by_definition(map.cloud().positions, 0.12, threshold);
      ASSERT_EQ(map.labels(), expected) << "batch " << batch << ", k " << threshold;
      // The reported changes transform the old frontiers into the new ones.
      const auto frontiers_now = frontiers(expected);
      std::vector<std::uint32_t> lost, won;
      std::set_difference(frontiers_before.begin(), frontiers_before.end(), frontiers_now.begin(),
                          frontiers_now.end(), std::back_inserter(lost));
      std::set_difference(frontiers_now.begin(), frontiers_now.end(), frontiers_before.begin(),
                          frontiers_before.end(), std::back_inserter(won));
      EXPECT_EQ(update.lost_frontiers, lost);
      EXPECT_EQ(update.new_frontiers, won);
      frontiers_before = frontiers_now;
    }
    EXPECT_FALSE(frontiers_before.empty());
  }
}

// A new point can turn a neighbour into a core point. This changes the labels of that neighbour's
// neighbours, which may have no new point nearby.
TEST(DensityMap, UpdatesLabelsTwoHopsFromNewPoints) {
  DensityMap map({.radius = 1.0, .core_threshold = 4, .spacing = 0.01});
  // A chain 0 - 1 - 2. Point 1 becomes core only when 3 and 4 arrive, which are close to 1 alone.
  map.insert(std::vector<Vector3f>{{0, 0, 0}, {0.9F, 0, 0}, {-0.5F, 0, 0}}, 0);
  map.relabel();
  map.insert(std::vector<Vector3f>{{1.6F, 0.3F, 0}, {1.6F, -0.3F, 0}}, 1);
  map.relabel();
  EXPECT_EQ(map.label(1), PointLabel::core);
  // Next to core 1 and outlier 2, without new points nearby.
  EXPECT_EQ(map.label(0), PointLabel::frontier);
}

// Trap T2 of the specification: with a threshold below 4 there cannot be frontiers.
TEST(DensityMap, HasNoFrontiersForCoreThresholdBelowFour) {
  DensityMap three({.radius = 0.12, .core_threshold = 3, .spacing = 0.02});
  DensityMap four({.radius = 0.12, .core_threshold = 4, .spacing = 0.02});
  for (std::uint32_t batch = 0; batch < 4; ++batch) {
    const auto points = tests::noisy_sphere(150, 0.05, batch);
    three.insert(points, batch);
    four.insert(points, batch);
    three.relabel();
    four.relabel();
    EXPECT_THAT(frontiers(three.labels()), IsEmpty());
  }
  EXPECT_FALSE(frontiers(four.labels()).empty());
}

// Trap T3: the order of points in a scan decides which points are kept, but never a label.
TEST(DensityMap, LabelsPointsIndependentlyOfOrder) {
  auto points = tests::noisy_sphere(800, 0.05, 9);
  DensityMap forwards({.radius = 0.1, .core_threshold = 4, .spacing = 0.0});
  forwards.insert(points, 0);
  forwards.relabel();
  std::reverse(points.begin(), points.end());
  DensityMap backwards({.radius = 0.1, .core_threshold = 4, .spacing = 0.0});
  for (std::uint32_t i = 0; i < points.size(); i += 100) {
    backwards.insert(std::span(points).subspan(i, 100), i);
    backwards.relabel();
  }
  auto labels = backwards.labels();
  std::reverse(labels.begin(), labels.end());
  EXPECT_EQ(forwards.labels(), labels);
}

// Trap T4: discarded frontiers remain discarded until a point arrives within r.
TEST(DensityMap, KeepsFrontiersDiscardedUntilNewPointIsNear) {
  DensityMap map({.radius = 1.0, .core_threshold = 5, .spacing = 0.01});
  // Core: points 0 to 4. Frontier: point 5, next to core 4 and outlier 6.
  const std::vector<Vector3f> first = {{0, 0, 0},    {-0.3F, 0, 0}, {0, 0.3F, 0}, {0, -0.3F, 0},
                                       {0.3F, 0, 0}, {1.25F, 0, 0}, {2.2F, 0, 0}};
  map.insert(first, 0);
  ASSERT_THAT(map.relabel().new_frontiers, ElementsAre(5));
  map.discard(5);
  EXPECT_EQ(map.label(5), PointLabel::outlier);

  // In a neighbouring cell, but not within r.
  map.insert(std::vector<Vector3f>{{1.9F, 0.9F, 0}}, 1);
  map.relabel();
  EXPECT_EQ(map.label(5), PointLabel::outlier);

  map.insert(std::vector<Vector3f>{{2.0F, 0.5F, 0}}, 2);  // within r
  EXPECT_THAT(map.relabel().new_frontiers, testing::Contains(5));
}

// R2 of the specification: an outlier that is tested again finds its own label among the outliers.
TEST(DensityMap, TurnsIsolatedOutlierIntoFrontierByLabelledRule) {
  const std::vector<Vector3f> core_group = {{0, 0, 0}, {0, 0.3F, 0}, {0, -0.3F, 0}, {0.3F, 0, 0}};
  for (const OutlierRule rule : {OutlierRule::non_core, OutlierRule::labelled}) {
    DensityMap map({.radius = 1.0, .core_threshold = 4, .spacing = 0.01, .rule = rule});
    map.insert(std::vector<Vector3f>{{1.25F, 0, 0}}, 0);
    map.relabel();
    map.insert(core_group, 1);
    map.relabel();
    EXPECT_EQ(map.label(0),
              rule == OutlierRule::non_core ? PointLabel::outlier : PointLabel::frontier);
  }
}

TEST(DensityMap, DoesNotDependOnThreadCount) {
  DensityMap one({.radius = 0.02, .core_threshold = 4, .spacing = 0.01});
  DensityMap three({.radius = 0.02, .core_threshold = 4, .spacing = 0.01});
  for (std::uint32_t view = 0; view < 3; ++view) {
    const auto points = tests::noisy_sphere(100'000, 0.01, view);
    one.insert(points, view, 1);
    one.relabel();
    three.insert(points, view, 3);
    three.relabel();
    ASSERT_EQ(one.cloud().positions, three.cloud().positions);
    ASSERT_EQ(one.labels(), three.labels());
  }
}

// No-return pixels are between the others. A fifth of the rows has no returns.
TEST(DensityMap, KeepsSamePointsForImageAndList) {
  const DensityConfig config{.radius = 0.02, .core_threshold = 4, .spacing = 0.01};
  DensityMap list(config), one(config), three(config);
  for (std::uint32_t view = 0; view < 3; ++view) {
    const auto points = tests::noisy_sphere(70'000, 0.01, view);
    constexpr std::uint32_t width = 300;
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t pixel = 0; pixels.size() < points.size(); ++pixel) {
      if (pixel / width % 5 != 4 && pixel % 7 != 3) pixels.push_back(pixel);
    }
    list.insert(points, view);
    one.insert(points, view, 1, {pixels, width});
    three.insert(points, view, 3, {pixels, width});
    for (DensityMap* map : {&list, &one, &three}) map->relabel();
    ASSERT_EQ(one.cloud().positions, list.cloud().positions);
    ASSERT_EQ(three.cloud().positions, list.cloud().positions);
    ASSERT_EQ(three.cloud().views, list.cloud().views);
  }
}

TEST(DensityMap, KeepsSpacingAndScanOfEachPoint) {
  DensityMap map({.radius = 0.5, .core_threshold = 4, .spacing = 0.1});
  map.insert(std::vector<Vector3f>{{0, 0, 0}, {0.05F, 0, 0}, {0.2F, 0, 0}}, 7);
  map.insert(std::vector<Vector3f>{{0.01F, 0, 0}, {0.4F, 0, 0}}, 8);
  map.relabel();
  EXPECT_THAT(map.cloud().views, ElementsAre(7, 7, 8));
  EXPECT_EQ(map.cloud().positions[2].x(), 0.4F);
}

}  // namespace
}  // namespace skycap::geometry
