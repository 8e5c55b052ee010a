#include "flight/clearance/clearance.h"

#include <cmath>
#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/flight/clearance/cgal_oracle.h"
#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

Obstacles solid(geometry::Mesh mesh) {
  Obstacles obstacles;
  obstacles.mesh = std::move(mesh);
  return obstacles;
}

struct Scene {
  const char* name;
  std::function<geometry::Mesh(std::mt19937_64&)> make;
  double clearance;
};

// NOLINTNEXTLINE(readability-identifier-naming): gtest looks for it
void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

class RandomSceneVerification : public testing::TestWithParam<Scene> {};

// Requirement for 20,000 legs in the four scenes: never accept a leg that the independent oracle
// rejects, and reject at most 0.1% of the legs that it accepts. The oracle only knows surfaces. The
// scenes are therefore shells here; solids have their own test.
TEST_P(RandomSceneVerification, MatchesCgalOracle) {
  std::mt19937_64 random(7);
  const Scene& scene = GetParam();
  Obstacles obstacles = solid(scene.make(random));
  obstacles.mesh_is_solid = false;
  const KnownSpace space(obstacles);
  const CgalOracle oracle(obstacles.mesh);
  Eigen::AlignedBox3d around = geometry::bounding_box(obstacles.mesh);
  around.min() -= Vector3d::Constant(5);
  around.max() += Vector3d::Constant(5);

  int accepted_by_oracle = 0, rejected_by_skycap = 0, violations = 0;
  for (const Segment& leg : scenes::legs(random, 5000, around)) {
    const Verdict verdict = oracle.classify(leg, scene.clearance);
    const LegVerification verification = verify(space, leg, scene.clearance);
    EXPECT_EQ(verification.is_verified, verification.clearance >= scene.clearance);
    EXPECT_EQ(space.is_free(leg, scene.clearance), verification.is_verified);
    if (verdict == Verdict::violated) {
      ++violations;
      EXPECT_FALSE(verification.is_verified) << "accepted a leg with a witness of violation";
    } else if (verdict == Verdict::clear) {
      ++accepted_by_oracle;
      rejected_by_skycap += verification.is_verified ? 0 : 1;
    }
  }
  EXPECT_GT(violations, 100);  // the scene contains enough violations for the test
  EXPECT_GT(accepted_by_oracle, 100);
  EXPECT_LE(rejected_by_skycap, accepted_by_oracle / 1000);
}

INSTANTIATE_TEST_SUITE_P(
    Clearance, RandomSceneVerification,
    testing::Values(Scene{"boxes", [](auto& r) { return scenes::boxes(r, 60); }, 2.0},
                    Scene{"poles", [](auto& r) { return scenes::poles(r, 80); }, 0.3},
                    Scene{"wires", [](auto& r) { return scenes::wires(r, 160); }, 0.3},
                    Scene{"city", [](auto&) { return scenes::city(2); }, 2.0}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

// The reported closest point is on the leg and has that distance from the mesh according to CGAL.
// No sampled point of the leg is closer.
TEST(Clearance, ReturnsTheClosestPointOfTheLeg) {
  std::mt19937_64 random(8);
  Obstacles obstacles = solid(scenes::wires(random, 40));
  obstacles.mesh_is_solid = false;
  const KnownSpace space(obstacles);
  const CgalOracle oracle(obstacles.mesh);
  const Eigen::AlignedBox3d around(Vector3d::Zero(), Vector3d::Constant(60));
  for (const Segment& leg : scenes::legs(random, 200, around)) {
    const Closest closest = space.closest(leg, 1e9);
    EXPECT_NEAR(oracle.distance(closest.on_leg), closest.distance, 1e-9);
    EXPECT_NEAR((closest.on_leg - closest.on_obstacle).norm(), closest.distance, 1e-9);
    for (int i = 0; i <= 100; ++i) {
      EXPECT_LE(closest.distance, oracle.distance(leg.at(i / 100.0)) + 1e-9);
    }
  }
}

TEST(Clearance, ReturnsNoObstacleBeyondSearchDistance) {
  const KnownSpace space(solid(scenes::box(Vector3d::Zero(), Vector3d::Ones())));
  const Segment leg{{0, 0, 4}, {1, 0, 4}};
  EXPECT_EQ(space.closest(leg, 2.0).kind, ObstacleKind::none);
  EXPECT_EQ(space.closest(leg, 2.0).distance, 2.0);
  EXPECT_NEAR(space.closest(leg, 9.0).distance, 3.0, 1e-12);
}

TEST(Clearance, RejectsLegInsideSolidForBothOrientations) {
  geometry::Mesh box = scenes::box({-20, -20, -20}, {20, 20, 20});
  const Segment deep_inside{{-1, 0, 0}, {1, 0, 0}}, outside{{30, 0, 0}, {35, 0, 0}};
  for (const bool inside_out : {false, true}) {
    if (inside_out) {
      for (auto& triangle : box.triangles) std::swap(triangle[0], triangle[1]);
    }
    const KnownSpace space(solid(box));
    EXPECT_FALSE(verify(space, deep_inside, 1.0).is_verified);
    EXPECT_FALSE(space.is_free(deep_inside, 1.0));
    EXPECT_TRUE(verify(space, outside, 1.0).is_verified);
    Obstacles shell = solid(box);
    shell.mesh_is_solid = false;
    EXPECT_TRUE(verify(KnownSpace(shell), deep_inside, 1.0).is_verified);
  }
}

TEST(Clearance, TreatsSelfIntersectingAndDuplicateMeshesAsSolid) {
  geometry::Mesh mesh = scenes::box({0, 0, 0}, {10, 10, 10});
  geometry::append(mesh, scenes::box({5, 5, 5}, {15, 15, 15}));
  geometry::append(mesh, scenes::box({0, 0, 0}, {10, 10, 10}));  // the first box again
  const KnownSpace space(solid(mesh));
  // The dipole approximation of the far field is inexact.
  EXPECT_NEAR(space.winding_number({7, 7, 7}), 3.0, 0.05);
  EXPECT_NEAR(space.winding_number({12, 12, 12}), 1.0, 0.05);
  EXPECT_NEAR(space.winding_number({2, 12, 2}), 0.0, 0.05);
  EXPECT_FALSE(space.is_free({{7, 7, 7}, {7.1, 7, 7}}, 0.1));
}

// In a concave sheet more than half of the view is surface, but a point above it is not inside.
TEST(Clearance, TreatsHollowOfOpenTerrainAsFree) {
  geometry::Mesh valley;
  valley.vertices = {{-10, -50, 20}, {0, -50, 0}, {10, -50, 20},
                     {-10, 50, 20},  {0, 50, 0},  {10, 50, 20}};
  valley.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  const KnownSpace space(solid(valley));
  EXPECT_TRUE(space.is_free({{0, -5, 10}, {0, 5, 10}}, 2.0));
  EXPECT_LT(space.winding_number({0, 0, 8}), -0.5);
}

TEST(Clearance, TreatsPointsAsBalls) {
  Obstacles obstacles;
  obstacles.cloud = {{{0, 0, 0}, {10, 0, 0}}, 0.5};
  const KnownSpace space(obstacles);
  const Closest closest = space.closest({{-5, 3, 0}, {15, 2, 0}}, 100);
  EXPECT_EQ(closest.kind, ObstacleKind::point);
  EXPECT_EQ(closest.index, 1U);
  // Distance of (10, 0) from the line through (-5, 3) and (15, 2), minus the radius.
  EXPECT_NEAR(closest.distance, 2.25 * 20.0 / std::sqrt(401.0) - 0.5, 1e-6);
  EXPECT_EQ(space.closest({{0, 0.2, 0}, {0, 0.3, 0}}, 100).distance, 0.0);
}

// A known problem of autopilots: both waypoints are outside a no-fly zone, but the leg crosses it.
TEST(Clearance, RejectsLegThroughNoFlyVolumeWithEndsOutside) {
  Obstacles obstacles;
  obstacles.no_fly = {{"heliport", {{10, -5}, {20, -5}, {20, 5}, {10, 5}}, 0.0, 50.0}};
  const KnownSpace space(obstacles);
  const LegVerification through = verify(space, {{0, 0, 20}, {30, 0, 20}}, 2.0);
  EXPECT_FALSE(through.is_verified);
  EXPECT_THAT(space.name(through.closest), HasSubstr("heliport"));
  // Above the zone's ceiling.
  EXPECT_TRUE(verify(space, {{0, 0, 53}, {30, 0, 53}}, 2.0).is_verified);
  EXPECT_NEAR(verify(space, {{0, 0, 53}, {30, 0, 53}}, 2.0).clearance, 3.0, 2e-6);
  EXPECT_FALSE(verify(space, {{14, 0, 20}, {16, 0, 20}}, 1.0).is_verified);  // completely inside
}

TEST(Clearance, RejectsFlightOverUnboundedNoFlyVolume) {
  Obstacles obstacles;
  obstacles.no_fly = {{"tower", {{10, -5}, {20, -5}, {20, 5}, {10, 5}}}};
  const KnownSpace space(obstacles);
  EXPECT_FALSE(space.is_free({{0, 0, 5000}, {30, 0, 5000}}, 1.0));
  EXPECT_TRUE(space.is_free({{0, 10, 20}, {30, 10, 20}}, 1.0));
}

TEST(Clearance, RejectsLegThatLeavesFenceBetweenWaypoints) {
  Obstacles obstacles;  // L shape: the straight line between its arms leaves the fence
  obstacles.fence = Prism{"site", {{0, 0}, {40, 0}, {40, 10}, {10, 10}, {10, 40}, {0, 40}}, 0, 30};
  const KnownSpace space(obstacles);
  EXPECT_TRUE(space.is_free({{5, 5, 10}, {35, 5, 10}}, 2.0));
  EXPECT_FALSE(space.is_free({{35, 5, 10}, {5, 35, 10}}, 0.0));
  EXPECT_FALSE(space.is_free({{50, 50, 10}, {60, 50, 10}}, 1.0));  // completely outside
  EXPECT_NEAR(space.closest({{5, 5, 28}, {5, 6, 28}}, 9).distance, 2.0, 1e-9);
}

// A distance that equals the clearance may be too short by its rounding error.
TEST(Clearance, RejectsLegsWithinTheGuardOfTheClearance) {
  Obstacles obstacles;
  obstacles.ground_height = 0.0;
  const KnownSpace space(obstacles);
  const auto is_verified_at = [&](double z) {
    return verify(space, {{0, 0, z}, {10, 0, z}}, 2.0).is_verified;
  };
  EXPECT_FALSE(is_verified_at(2.0));
  EXPECT_FALSE(is_verified_at(2.0 + 0.5 * clearance_guard));
  EXPECT_TRUE(is_verified_at(2.0 + 2.0 * clearance_guard));
}

TEST(Clearance, TreatsGroundAsSolid) {
  Obstacles obstacles;
  obstacles.ground_height = 10.0;
  const KnownSpace space(obstacles);
  EXPECT_NEAR(space.closest({{0, 0, 13}, {9, 0, 15}}, 9).distance, 3.0, 1e-12);
  EXPECT_EQ(space.closest({{0, 0, 5}, {9, 0, 15}}, 9).distance, 0.0);
  EXPECT_EQ(space.closest({{0, 0, 13}, {9, 0, 15}}, 9).kind, ObstacleKind::ground);
}

TEST(Clearance, IsFreeInJointSpaceOnlyWhereAllSpacesAreFree) {
  Obstacles building = solid(scenes::box({0, 0, 0}, {10, 10, 10}));
  Obstacles rules;
  rules.ground_height = 0.0;
  const KnownSpace scene(building), no_fly(rules);
  const JointSpace both({&scene, &no_fly});
  EXPECT_EQ(both.closest({{20, 0, 3}, {30, 0, 3}}, 99).kind, ObstacleKind::ground);
  EXPECT_EQ(both.closest({{12, 0, 9}, {30, 0, 9}}, 99).kind, ObstacleKind::mesh);
  EXPECT_FALSE(both.continues_free({{20, 0, 3}, {30, 0, 3}}, 4.0));
  EXPECT_TRUE(both.is_free({{20, 0, 5}, {30, 0, 5}}, 4.0));
}

}  // namespace
}  // namespace skycap::flight
