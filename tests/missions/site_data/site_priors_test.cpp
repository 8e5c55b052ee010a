#include "missions/site_data/site_priors.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/site_data/missing_terrain.h"
#include "missions/site_data/surface_points.h"
#include "tests/flight/scenes.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// Returns a grid with a height every metre, 0 to 4 m east and 0 to 3 m north. `z` gives the height
/// of each node.
template <typename Height>
HeightGrid make_grid(Height z) {
  HeightGrid grid{.columns = 5, .rows = 4, .nodes = {}, .right = {1, 0}, .down = {0, -1}};
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
  return flight::PriorObstacle(make_obstacle({.file = "dsm.tif"}, prior));
}

// Between the nodes of a cell, space below the highest one is occupied, also half a cell beyond the
// grid.
TEST(SitePriors, FillSurfaceModelBelowMaxNodeOfEachCell) {
  const auto obstacle =
      surface_model(make_grid([](int x, int y) { return x == 2 && y == 1 ? 9.0 : 1.0; }));
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

TEST(SitePriors, IgnoreNodesWithoutHeight) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto obstacle = surface_model(make_grid([&](int x, int) { return x < 3 ? 1.0 : nan; }));
  EXPECT_EQ(obstacle.distance({1.5, 1.5, 0.0}, 100), 0.0);
  EXPECT_NEAR(obstacle.extent().max().x(), 2.5, 1e-6) << "the cells of the last nodes end there";
}

// The width of a single row is that of its cells.
TEST(SitePriors, FillSurfaceModelOfOneRow) {
  HeightGrid row{.columns = 3, .rows = 1, .nodes = {}, .right = {2, 0}, .down = {0, -2}};
  for (const float x : {0.0F, 2.0F, 4.0F}) row.nodes.emplace_back(x, 0.0F, 7.0F);
  const auto obstacle = surface_model(row);
  EXPECT_TRUE(
      obstacle.extent().isApprox(Eigen::AlignedBox3d(Vector3d(-1, -1, 7), Vector3d(5, 1, 7))));
  HeightGrid node{.columns = 1, .rows = 1, .nodes = {{3, 3, 5}}, .right = {2, 0}, .down = {0, -2}};
  EXPECT_EQ(surface_model(node).distance({3.9, 2.1, 4.9}, 10), 0.0);
}

// A large grid is stored with fewer columns. None of them is lower than any of its nodes.
TEST(SitePriors, KeepMaxHeightsInDownsampledSurfaceModel) {
  HeightGrid grid{.columns = 1700, .rows = 1700, .nodes = {}, .right = {1, 0}, .down = {0, 1}};
  for (int row = 0; row < 1700; ++row) {
    for (int column = 0; column < 1700; ++column) {
      const double z = 5.0 + 4.0 * std::sin(0.7 * column) * std::cos(0.9 * row);
      grid.nodes.emplace_back(static_cast<float>(column), static_cast<float>(row),
                              static_cast<float>(z));
    }
  }
  const auto config = make_obstacle({.file = "dsm.tif"}, Prior{.grid = grid});
  EXPECT_LT(config.columns.size(), 2'000'000U);
  const flight::PriorObstacle obstacle(config);
  ASSERT_FALSE(grid.nodes.empty());
  for (std::size_t i = 0; i < grid.nodes.size(); i += 997) {
    EXPECT_EQ(obstacle.distance(grid.nodes[i].cast<double>(), 1.0), 0.0);
  }
}

TEST(Terrain, InterpolatesPlaneThroughNodes) {
  Prior prior;
  prior.grid = make_grid([](int x, int y) { return 0.5 * x - 0.25 * y; });
  const Terrain terrain({&prior});
  for (double x = 0.05; x < 4.0; x += 0.37) {
    for (double y = 0.05; y < 3.0; y += 0.29) {
      EXPECT_NEAR(terrain.height(Vector2d(x, y)).value(), 0.5 * x - 0.25 * y, 1e-5);
    }
  }
  EXPECT_FALSE(terrain.height({-1.0, 1.0}));
  EXPECT_NEAR(terrain.height({-0.4, 1.0}).value(), -0.25, 1e-5) << "half a cell beyond the node";
  EXPECT_NEAR(terrain.height({-0.4, -0.4}).value(), 0.0, 1e-5);
}

// Nodes next to a missing node still have their own cells.
TEST(Terrain, EndsHalfACellFromLastNodes) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Prior prior;
  prior.grid = make_grid([](int, int) { return 2.0; });
  prior.grid.nodes[1 * 5 + 2] = {nan, nan, nan};  // position (2, 2)
  const Terrain terrain({&prior});
  EXPECT_NEAR(terrain.height({1.45, 2.0}).value(), 2.0, 1e-6);
  EXPECT_NEAR(terrain.height({2.0, 1.45}).value(), 2.0, 1e-6);
  EXPECT_FALSE(terrain.height({1.6, 2.0}));
  EXPECT_FALSE(terrain.height({2.3, 2.3}));
}

// In a grid that is too large to be stored completely, peaks between the stored nodes are kept.
TEST(Terrain, KeepsPeaksOfLargeGrid) {
  Prior prior;
  prior.grid = {.columns = 2000, .rows = 2000, .nodes = {}, .right = {1, 0}, .down = {0, 1}};
  for (int row = 0; row < 2000; ++row) {
    for (int column = 0; column < 2000; ++column) {
      prior.grid.nodes.emplace_back(static_cast<float>(column), static_cast<float>(row),
                                    row % 97 == 13 && column % 89 == 7 ? 30.0F : 1.0F);
    }
  }
  const Terrain terrain({&prior});
  ASSERT_FALSE(prior.grid.nodes.empty());
  for (std::size_t i = 0; i < prior.grid.nodes.size(); i += 1237) {
    const Vector3f& node = prior.grid.nodes[i];
    EXPECT_GE(terrain.height(node.head<2>().cast<double>()).value(), node.z() - 1e-4);
  }
  for (int row = 13; row < 2000; row += 97) {
    for (int column = 7; column < 2000; column += 89) {
      EXPECT_GE(terrain.height(Vector2d(column, row)).value(), 30.0 - 1e-4);
    }
  }
}

/// Returns a flat obstacle of 1 m columns at integer positions where `is_there` returns true.
template <typename IsThere>
flight::PriorObstacleConfig ground_where(const IsThere& is_there, double z) {
  flight::PriorObstacleConfig ground{.name = "ground", .uncertainty = 0.4, .is_ground = true};
  for (int x = -20; x < 20; ++x) {
    for (int y = -20; y < 20; ++y) {
      if (!is_there(x + 0.5, y + 0.5)) continue;
      ground.columns.emplace_back(Vector3d(x, y, z - 1), Vector3d(x + 1, y + 1, z));
    }
  }
  return ground;
}

/// Returns the highest occupied z at this position, within 50 m.
double top_at(const flight::PriorObstacle& obstacle, double x, double y) {
  double low = -50.0, high = 50.0;
  while (high - low > 1e-6) {
    const double z = 0.5 * (low + high);
    (obstacle.distance({x, y, z}, 1.0) == 0.0 ? low : high) = z;
  }
  return low;
}

// Around a tile rotated by 45 degrees, the plane applies, both inside and outside the tile's
// bounding box.
TEST(UnknownGround, IsPlaneOutsideRotatedTile) {
  const UnknownGround unknown(
      {ground_where([](double x, double y) { return std::abs(x) + std::abs(y) < 20.0; }, 7.0)},
      -3.0);
  const flight::PriorObstacle obstacle(unknown.obstacle());
  EXPECT_TRUE(obstacle.is_ground());
  EXPECT_NEAR(top_at(obstacle, 17, 17), -3.0 + 0.4, 1e-5);
  EXPECT_NEAR(top_at(obstacle, -15, 12), -3.0 + 0.4, 1e-5);
  EXPECT_NEAR(top_at(obstacle, 300, 0), -3.0 + 0.4, 1e-5);
  EXPECT_LT(top_at(obstacle, 0, 0), -5.0) << "the tile itself knows its ground";
  EXPECT_THAT(unknown.note(), testing::HasSubstr("plane z = -3.00 m"));
}

// A hole within the ground is as high as the highest ground around it. A gap between two tiles that
// is open to the sides has the height of the plane.
TEST(UnknownGround, HasMaxHeightOfSurroundingGround) {
  const auto in_hole = [](double x, double y) { return x > 5 && x < 8 && y > -4 && y < 3; };
  const auto west = [](double x, double) { return x < -10; };
  const UnknownGround unknown(
      {ground_where([&](double x, double y) { return x > -8 && !in_hole(x, y) && x < 8.6; }, 2.0),
       ground_where([&](double x, double) { return x > 8.6; }, 9.0), ground_where(west, 2.0)},
      -1.0);
  const flight::PriorObstacle obstacle(unknown.obstacle());
  EXPECT_NEAR(top_at(obstacle, 6.5, 0.0), 2.0 + 0.4, 1e-5);
  EXPECT_NEAR(top_at(obstacle, -9.0, 0.0), -1.0 + 0.4, 1e-5);
  EXPECT_EQ(unknown.height({6.5, 0.0}), 2.0);
  EXPECT_EQ(unknown.height({-9.0, 0.0}), -1.0);
  EXPECT_EQ(unknown.height({0.0, 300.0}), -1.0);
  EXPECT_THAT(unknown.note(), testing::HasSubstr("1 holes"));
}

TEST(Terrain, UsesMaxHeightOfSurface) {
  Prior prior;
  prior.objects.push_back({.id = "hill", .mesh = flight::scenes::box({0, 0, 0}, {10, 10, 3})});
  EXPECT_NEAR(Terrain({&prior}).height({4.0, 7.0}).value(), 3.0, 1e-9);
}

// A rotated box of 2 x 3 x 4 m: points are on walls and roof and face outward. The bottom has none.
TEST(SurfacePoints, CoverVisibleSurfaceFacingOutward) {
  Object object{.id = "1", .mesh = flight::scenes::box({0, 0, 0}, {2, 3, 4})};
  object.surfaces.assign(object.mesh.triangles.size(), SurfaceKind::wall);
  for (const bool is_inward : {false, true}) {
    if (is_inward) {
      for (auto& triangle : object.mesh.triangles) std::swap(triangle[1], triangle[2]);
    }
    const SurfacePoints points = spread_over(object, 100'000, 0.1);
    const double area = 2.0 * (2 * 4 + 3 * 4) + 2 * 3;
    EXPECT_NEAR(points.area_per_point * static_cast<double>(points.positions.size()), area, 1e-6);
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
}  // namespace skycap::missions::site_data
