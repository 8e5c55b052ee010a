#include "survey/fixed_views/view_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/random_numbers.h"
#include "survey/fixed_views/fixed_view_planner.h"
#include "tests/support/complaint.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey::fixed_views {
namespace {

using Eigen::Vector3d;
using geometry::View;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double pi = std::numbers::pi;

std::vector<double> nearest_angles(const std::vector<Vector3d>& directions) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    double max_cosine = -1.0;
    for (std::size_t j = 0; j < directions.size(); ++j) {
      if (j != i) max_cosine = std::max(max_cosine, directions[i].dot(directions[j]));
    }
    angles.push_back(std::acos(std::min(max_cosine, 1.0)));
  }
  return angles;
}

// A lattice of n cells of equal area has neighbours at about the root of the area of a cell.
TEST(ViewSet, DistributesFibonacciLatticeEvenly) {
  for (const double min_z : {-1.0, 0.0}) {
    for (const std::size_t count : {10U, 30U, 100U, 300U}) {
      const auto directions =
          make_directions(ViewSet::fibonacci, count, {min_z, 1.0}, 1, 3 + count);
      ASSERT_EQ(directions.size(), count);
      const auto angles = nearest_angles(directions);
      const double cell = std::sqrt(2.0 * pi * (1.0 - min_z) / static_cast<double>(count));
      const double mean =
          std::accumulate(angles.begin(), angles.end(), 0.0) / static_cast<double>(count);
      EXPECT_GE(mean / cell, 0.92) << count << " above " << min_z;
      EXPECT_LE(mean / cell, 0.97) << count << " above " << min_z;
      EXPECT_GE(*std::ranges::min_element(angles) / cell, 0.87) << count << " above " << min_z;
    }
  }
}

// Archimedes: uniform by area is uniform in z.
TEST(ViewSet, DrawsRandomDirectionsUniformlyByArea) {
  constexpr std::size_t count = 20'000;
  double mean = 0.0, square = 0.0;
  for (const Vector3d& direction : make_directions(ViewSet::random, count, {-0.5, 1.0}, 1, 11)) {
    EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
    EXPECT_GE(direction.z(), -0.5);
    mean += direction.z() / count;
    square += direction.z() * direction.z() / count;
  }
  const double variance = 1.5 * 1.5 / 12.0;
  EXPECT_NEAR(mean, 0.25, 5.0 * std::sqrt(variance / count));
  EXPECT_NEAR(square - mean * mean, variance, 0.01);
}

TEST(ViewSet, DistributesRingsOverHeights) {
  const auto directions = make_directions(ViewSet::rings, 30, {0.0, 1.0}, 5, 1);
  ASSERT_EQ(directions.size(), 30U);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    EXPECT_NEAR(directions[i].z(), 0.9 - 0.2 * static_cast<double>(i / 6), 1e-12) << i;
  }
}

TEST(ViewSet, DependsOnSeedOnly) {
  for (const ViewSet set : {ViewSet::fibonacci, ViewSet::rings, ViewSet::random}) {
    const auto once = make_directions(set, 12, {}, 2, 5),
               again = make_directions(set, 12, {}, 2, 5);
    const auto other = make_directions(set, 12, {}, 2, 6);
    EXPECT_EQ(once, again);
    EXPECT_NE(once, other);
  }
}

TEST(SphereBand, FollowsHeightAndPitchLimits) {
  const ViewLimits limits{.min_height = 1.0, .max_pitch = 0.0};
  const SphereBand band = compute_band(limits, {0.0, 0.0, 2.0}, 4.0);
  EXPECT_DOUBLE_EQ(band.min_z, 0.0);  // the pitch forbids views from below, the height only -0.25
  EXPECT_DOUBLE_EQ(band.max_z, 1.0);
  EXPECT_DOUBLE_EQ(compute_band({.min_height = 1.0}, {0.0, 0.0, 2.0}, 4.0).min_z, -0.25);
  EXPECT_THAT(testing_support::thrown_message(
                  [] { compute_band({.min_height = 9.0}, Vector3d::Zero(), 4.0); }),
              HasSubstr("no part of the sphere"));
}

// Half of the space is closed: views there move outwards until they are behind the wall's end.
TEST(ViewSet, KeepsNumberAndAdmissibilityWithForbiddenSpace) {
  FixedViewsConfig config;
  config.settings.views = 25;
  config.radius = 2.0;
  config.admits = [](const View& view) {
    return view.position.x() > 0.5 || view.position.norm() > 3.0;
  };
  const auto views = make_view_set(config);
  ASSERT_EQ(views.size(), 24U);
  for (const View& view : views) {
    EXPECT_TRUE(config.admits(view)) << view.position.transpose();
    EXPECT_LT((view.position.normalized() + view.direction).norm(), 1e-12);
    EXPECT_LE(view.position.norm(), 4.0 + 1e-9);
  }
  config.admits = [](const View& view) { return view.position.x() > 0.5; };
  const auto one_side = make_view_set(config);
  EXPECT_EQ(one_side.size(), 24U);
  config.admits = [](const View&) { return false; };
  EXPECT_TRUE(make_view_set(config).empty());
}

TEST(Tour, VisitsLineFromEndToEnd) {
  const std::vector<Vector3d> line{{3, 0, 0}, {1, 0, 0}, {4, 0, 0}, {2, 0, 0}};
  EXPECT_THAT(compute_tour(Vector3d::Zero(), line), ElementsAre(1, 3, 0, 2));
}

// Twin: all orders. A local optimum of 2-opt and or-opt with 7 positions is rarely above the best.
TEST(Tour, IsPermutationNearTheBestOrder) {
  geometry::RandomNumbers random(4);
  std::size_t optimal = 0;
  constexpr std::size_t repetitions = 20;
  for (std::size_t repetition = 0; repetition < repetitions; ++repetition) {
    std::vector<Vector3d> positions(7);
    for (Vector3d& position : positions) {
      for (int axis = 0; axis < 3; ++axis) position[axis] = random.uniform();
    }
    const Vector3d start = Vector3d::Zero();
    std::vector<std::size_t> order(positions.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto tour = compute_tour(start, positions);
    EXPECT_TRUE(std::ranges::is_permutation(tour, order));
    double best = path_length(start, positions, order);
    while (std::ranges::next_permutation(order).found) {
      best = std::min(best, path_length(start, positions, order));
    }
    const double length = path_length(start, positions, tour);
    EXPECT_LE(length, 1.15 * best);
    if (length < best + 1e-9) ++optimal;
  }
  EXPECT_GE(optimal, repetitions * 3 / 5);
}

TEST(Spread, TakesFarthestPositionFirst) {
  const std::vector<Vector3d> line{{3, 0, 0}, {1, 0, 0}, {4, 0, 0}, {2, 0, 0}};
  EXPECT_THAT(compute_spread(Vector3d::Zero(), line), ElementsAre(2, 3, 0, 1));
}

TEST(FixedViewPlanner, TakesGivenNumberOfViewsOnSphere) {
  const geometry::Camera camera({.width = 53, .height = 30});
  FixedViewsConfig config;
  config.settings.views = 9;
  config.radius = 2.0;
  config.spacing = 0.02;
  FixedViewPlanner planner(config);
  std::optional<View> view = geometry::look_at({2.5, 0.0, 0.0}, Vector3d::Zero());
  std::size_t views = 0;
  for (; view; ++views) {
    if (views > 0) {
      EXPECT_NEAR(view->position.norm(), 2.0, 1e-9);
    }
    const std::vector<tests::Sphere> spheres{{{0, 0, 0}, 0.4}};
    view = planner.next_view(tests::scan_spheres(spheres, camera, *view, 0.0, views + 1));
  }
  EXPECT_EQ(views, 9U);
  EXPECT_GT(planner.cloud().size(), 100U);
}

}  // namespace
}  // namespace skycap::survey::fixed_views
