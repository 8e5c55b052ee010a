#include "missions/prior/site_priors.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/prior/surface_points.h"
#include "tests/flight/scenes.h"

namespace skycap::missions::prior {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// Heights every metre on 0 to 4 east, 0 to 3 north; `z` of each node.
template <typename Height>
HeightGrid grid_of(Height z) {
  HeightGrid grid{.columns = 5, .rows = 4, .nodes = {}};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 5; ++column) {
      grid.nodes.emplace_back(static_cast<float>(column), static_cast<float>(3 - row),
                              static_cast<float>(z(column, 3 - row)));
    }
  }
  return grid;
}

flight::PriorObstacle surface_model(const HeightGrid& grid) {
  const Prior prior{.role = Role::obstacle, .uncertainty = 0.0, .grid = grid};
  return flight::PriorObstacle(obstacle_of({.file = "dsm.tif"}, prior));
}

// Above and between the nodes of a cell its highest one is in the way, half a cell beyond the grid
// too.
TEST(SitePriors, ASurfaceModelIsSolidUnderTheHighestNodeOfEachCell) {
  const auto obstacle =
      surface_model(grid_of([](int x, int y) { return x == 2 && y == 1 ? 9.0 : 1.0; }));
  const auto height_over = [&](double x, double y) {
    return 20.0 - obstacle.distance({x, y, 20.0}, 100);
  };
  EXPECT_NEAR(height_over(2.0, 1.0), 9.0, 1e-6);
  EXPECT_NEAR(height_over(1.1, 0.1), 9.0, 1e-6) << "a corner of this cell is that high";
  EXPECT_NEAR(height_over(2.9, 1.9), 9.0, 1e-6);
  EXPECT_LT(height_over(0.0, 0.0), 9.0);
  EXPECT_EQ(obstacle.distance({2.0, 1.0, 3.0}, 100), 0.0);
  EXPECT_EQ(obstacle.distance({-0.4, 1.5, 0.5}, 100), 0.0);
  EXPECT_GT(obstacle.distance({-0.6, 1.5, 0.5}, 100), 0.0);
  EXPECT_NEAR(obstacle.distance({-2.5, 1.5, 0.5}, 100), 2.0, 1e-6);
}

TEST(SitePriors, NodesWithoutAHeightAreNoneOfIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto obstacle = surface_model(grid_of([&](int x, int) { return x < 3 ? 1.0 : nan; }));
  EXPECT_EQ(obstacle.distance({1.5, 1.5, 0.0}, 100), 0.0);
  EXPECT_NEAR(obstacle.extent().max().x(), 2.0, 1e-6);
}

// A large grid is held in fewer columns, none of which is lower than any of its nodes.
TEST(SitePriors, AThinnedSurfaceModelHidesNoHeight) {
  HeightGrid grid{.columns = 1700, .rows = 1700, .nodes = {}};
  for (int row = 0; row < 1700; ++row) {
    for (int column = 0; column < 1700; ++column) {
      const double z = 5.0 + 4.0 * std::sin(0.7 * column) * std::cos(0.9 * row);
      grid.nodes.emplace_back(static_cast<float>(column), static_cast<float>(row),
                              static_cast<float>(z));
    }
  }
  const auto config = obstacle_of({.file = "dsm.tif"}, Prior{.grid = grid});
  EXPECT_LT(config.columns.size(), 2'000'000U);
  const flight::PriorObstacle obstacle(config);
  for (std::size_t i = 0; i < grid.nodes.size(); i += 997) {
    EXPECT_EQ(obstacle.distance(grid.nodes[i].cast<double>(), 1.0), 0.0);
  }
}

TEST(Terrain, IsAsHighAsThePlaneThroughItsNodes) {
  Prior prior;
  prior.grid = grid_of([](int x, int y) { return 0.5 * x - 0.25 * y; });
  const Terrain terrain({&prior});
  for (double x = 0.05; x < 4.0; x += 0.37) {
    for (double y = 0.05; y < 3.0; y += 0.29) {
      EXPECT_NEAR(terrain.height(Vector2d(x, y)).value(), 0.5 * x - 0.25 * y, 1e-5);
    }
  }
  EXPECT_FALSE(terrain.height({-1.0, 1.0}));
}

TEST(Terrain, OfASurfaceIsItsTop) {
  Prior prior;
  prior.objects.push_back({.id = "hill", .mesh = flight::scenes::box({0, 0, 0}, {10, 10, 3})});
  EXPECT_NEAR(Terrain({&prior}).height({4.0, 7.0}).value(), 3.0, 1e-9);
}

// A box of 2 x 3 x 4 m, as its file turns it: points on walls and roof, outward, none below.
TEST(SurfacePoints, CoverWhatCanBeSeenFacingOutward) {
  Object object{.id = "1", .mesh = flight::scenes::box({0, 0, 0}, {2, 3, 4})};
  object.surfaces.assign(object.mesh.triangles.size(), SurfaceKind::wall);
  for (const bool is_inward : {false, true}) {
    if (is_inward) {
      for (auto& triangle : object.mesh.triangles) std::swap(triangle[1], triangle[2]);
    }
    const SurfacePoints points = spread_over(object, 100'000, 0.1);
    const double area = 2.0 * (2 * 4 + 3 * 4) + 2 * 3;
    EXPECT_NEAR(points.area_of_each * static_cast<double>(points.positions.size()), area, 1e-6);
    EXPECT_NEAR(static_cast<double>(points.positions.size()), area / 0.01, 1.0);
    const Vector3f middle(1.0F, 1.5F, 2.0F);
    for (std::size_t i = 0; i < points.positions.size(); ++i) {
      EXPECT_GT(points.normals[i].dot(points.positions[i] - middle), 0.0F);
      EXPECT_TRUE(points.positions[i].z() > 0.0F || std::abs(points.normals[i].z()) < 0.5F);
      EXPECT_EQ(points.kinds[i], SurfaceKind::wall);
    }
  }
}

}  // namespace
}  // namespace skycap::missions::prior
