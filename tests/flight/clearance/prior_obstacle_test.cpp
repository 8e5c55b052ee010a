#include "flight/clearance/prior_obstacle.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/flight/clearance/cgal_oracle.h"
#include "tests/flight/scenes.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::HasSubstr;

const AlignedBox3d house{Vector3d(0, 0, 0), Vector3d(10, 10, 8)};

PriorObstacleConfig house_model(double uncertainty) {
  PriorObstacleConfig config{.name = "the prior town.obj", .uncertainty = uncertainty};
  config.surfaces = {{"house 7", scenes::box(house.min(), house.max())}};
  return config;
}

TEST(PriorObstacle, IsEnlargedByItsUncertainty) {
  const PriorObstacle obstacle(house_model(0.5));
  const Segment leg{{15, 2, 4}, {15, 8, 4}};
  const Closest closest = obstacle.closest(leg, 100);
  EXPECT_NEAR(closest.distance, 4.5, 1e-9);
  EXPECT_EQ(obstacle.name(closest), "house 7 of the prior town.obj");
  EXPECT_TRUE(obstacle.is_free(leg, 4.4));
  EXPECT_FALSE(obstacle.is_free(leg, 4.6));
  EXPECT_EQ(obstacle.closest(leg, 4.0).kind, ObstacleKind::none);
  EXPECT_NEAR(obstacle.surface_distance({15, 5, 4}, 100), 4.5, 1e-9);
}

TEST(PriorObstacle, IsOccupiedInside) {
  const PriorObstacle obstacle(house_model(0.1));
  EXPECT_EQ(obstacle.distance({5, 5, 4}, 100), 0.0);
  EXPECT_FALSE(obstacle.is_free({{5, 5, 3}, {5, 5, 4}}, 0.5));
  EXPECT_EQ(obstacle.distance({10.05, 5, 4}, 100), 0.0) << "within what it may be off";
}

// Cloud points are balls. A point represents surface up to the diagonal of its cube away.
TEST(PriorObstacle, EnlargesPointsByRadiusAndUncertainty) {
  PriorObstacleConfig config{.name = "the prior scan.las", .uncertainty = 0.3};
  config.points = {{0, 0, 5}, {1, 0, 5}};
  config.point_radius = 0.2;
  const PriorObstacle obstacle(config);
  EXPECT_NEAR(obstacle.distance({0, 0, 7}, 10), 2.0 - 0.2 - 0.3, 1e-6);
  EXPECT_EQ(obstacle.name(obstacle.closest({{0, 0, 7}, {0, 0, 7}}, 10)), config.name);
}

// Space below a height model, under a roof or a crown, is occupied as well.
TEST(PriorObstacle, ExtendsColumnsDownwardWithoutLimit) {
  PriorObstacleConfig config{.name = "the prior dsm.tif", .uncertainty = 1.0};
  config.columns = {{Vector3d(0, 0, 4), Vector3d(1, 1, 5)}};
  const PriorObstacle obstacle(config);
  EXPECT_NEAR(obstacle.distance({0.5, 0.5, 9}, 10), 3.0, 1e-9);
  EXPECT_EQ(obstacle.distance({0.5, 0.5, -500}, 10), 0.0);
  EXPECT_NEAR(obstacle.distance({4, 0.5, 0}, 10), 2.0, 1e-9);
  EXPECT_NEAR(obstacle.extent().min().z(), 3.0, 1e-9) << "no path leads below the world";
}

TEST(PriorObstacle, IsGroundForTerrainAndCloudsOnly) {
  EXPECT_FALSE(PriorObstacle(house_model(0.1)).is_ground());
  PriorObstacleConfig terrain = house_model(0.1);
  terrain.is_ground = true;
  EXPECT_TRUE(PriorObstacle(terrain).is_ground());
  PriorObstacleConfig cloud{.name = "cloud"};
  cloud.points = {{0, 0, 0}};
  EXPECT_TRUE(PriorObstacle(cloud).is_ground());

  Obstacles site;
  site.priors = {std::make_shared<const PriorObstacle>(cloud),
                 std::make_shared<const PriorObstacle>(house_model(0.1))};
  EXPECT_EQ(without_ground(site).priors.size(), 1U);
}

TEST(PriorObstacle, RejectsInvalidConfigurations) {
  const auto error_message = [](const PriorObstacleConfig& config) {
    return testing_support::thrown_message([&] { PriorObstacle{config}; });
  };
  PriorObstacleConfig config = house_model(-1.0);
  EXPECT_THAT(error_message(config), HasSubstr("the prior town.obj has an uncertainty of -1"));
  config = {.name = "x"};
  config.points = {{0, 0, std::numeric_limits<float>::infinity()}};
  EXPECT_THAT(error_message(config), HasSubstr("x has a non-finite point"));
  config = {.name = "x"};
  config.columns.emplace_back();
  EXPECT_THAT(error_message(config), HasSubstr("x has an empty or non-finite column"));
}

// The closest obstacle counts and is reported by its own name.
TEST(KnownSpace, IncludesPriorObstacles) {
  Obstacles site;
  site.ground_height = 0.0;
  site.priors = {std::make_shared<const PriorObstacle>(house_model(0.5))};
  PriorObstacleConfig tree{.name = "the prior trees.las"};
  tree.points = {{30, 5, 4}};
  site.priors.push_back(std::make_shared<const PriorObstacle>(tree));
  const KnownSpace space(site);
  const auto nearest_to = [&](const Vector3d& position) {
    return space.name(space.closest({position, position}, 100));
  };
  EXPECT_EQ(nearest_to({14, 5, 6}), "house 7 of the prior town.obj");
  EXPECT_EQ(nearest_to({27, 5, 6}), "the prior trees.las");
  EXPECT_EQ(nearest_to({20, 50, 3}), "the ground");
  EXPECT_NEAR(space.distance({14, 5, 6}, 100), 3.5, 1e-9);
  EXPECT_NEAR(space.surface_distance({14, 5, 6}, 100), 3.5, 1e-9);
  EXPECT_FALSE(space.is_free({{14, 5, 6}, {14, 8, 6}}, 3.6));
  EXPECT_TRUE(space.is_free({{14, 5, 6}, {14, 8, 6}}, 3.4));
  EXPECT_TRUE(space.extent().contains(Vector3d(30, 5, 4)));
}

/// Random boxes as surfaces and as columns, the same boxes as one mesh for the oracle, and balls.
struct RandomTown {
  PriorObstacleConfig config{.name = "town"};
  std::vector<AlignedBox3d> boxes;
  geometry::Mesh mesh;

  explicit RandomTown(std::mt19937_64& random) {
    std::uniform_real_distribution<double> side(0.5, 6.0), error(0.0, 2.0);
    const AlignedBox3d site(Vector3d(-30, -30, 0), Vector3d(30, 30, 20));
    config.uncertainty = error(random);
    for (int i = 0; i < 40; ++i) {
      const Vector3d low = scenes::point_in(random, site);
      const double x = side(random), y = side(random), z = side(random);
      AlignedBox3d box(low, low + Vector3d(x, y, z));
      if (i % 2 == 0) {
        config.surfaces.push_back({"", scenes::box(box.min(), box.max())});
      } else {
        config.columns.push_back(box);
        box.min().z() = -200.0;  // far below all legs
      }
      boxes.push_back(box);
      geometry::append(mesh, scenes::box(box.min(), box.max()));
    }
    config.point_radius = 0.1 + 0.2 * error(random);
    for (int i = 0; i < 60; ++i) {
      config.points.push_back(scenes::point_in(random, site).cast<float>());
    }
  }
  /// Returns the distance between a leg and the surface of the closest ball.
  double nearest_ball(const Segment& leg) const {
    double min = 1e9;
    const Vector3d along = (leg.to - leg.from).normalized();
    for (const Eigen::Vector3f& point : config.points) {
      const Vector3d from = point.cast<double>() - leg.from;
      const double at = std::clamp(from.dot(along), 0.0, leg.length());
      min = std::min(min, (from - at * along).norm() - config.point_radius);
    }
    return min;
  }
  bool contains(const Vector3d& point) const {
    return std::ranges::any_of(boxes, [&](const auto& box) { return box.contains(point); });
  }
};

// 10^5 legs are compared with an independent oracle. No leg is verified that exact geometry
// rejects, and very few are rejected that it accepts.
TEST(PriorObstacle, VerifiesOnlyLegsThatCgalAccepts) {
  std::mt19937_64 random(19);
  std::uniform_real_distribution<double> clearances(0.0, 4.0);
  std::size_t verified = 0, rejected = 0, needlessly = 0;
  for (int town_number = 0; town_number < 20; ++town_number) {
    const RandomTown town(random);
    const PriorObstacle obstacle(town.config);
    const CgalOracle oracle(town.mesh);
    const AlignedBox3d around(Vector3d(-40, -40, -5), Vector3d(40, 40, 40));
    for (const Segment& leg : scenes::legs(random, 5000, around)) {
      const double clearance = clearances(random);
      const bool is_free = obstacle.is_free(leg, clearance);
      EXPECT_EQ(is_free, verify(obstacle, leg, clearance).is_verified);
      const Verdict verdict = oracle.classify(leg, clearance + town.config.uncertainty);
      const bool is_clear = verdict == Verdict::clear && !town.contains(leg.from) &&
                            town.nearest_ball(leg) > clearance + town.config.uncertainty;
      if (is_free) {
        ++verified;
        ASSERT_TRUE(is_clear) << "town " << town_number << ", clearance " << clearance;
      } else {
        ++rejected;
        needlessly += is_clear ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(verified + rejected, 100'000U);
  EXPECT_GT(verified, 10'000U);
  EXPECT_GT(rejected, 10'000U);
  EXPECT_LT(needlessly, 5U) << "but for the guard against rounding";
}

}  // namespace
}  // namespace skycap::flight
