#include "flight/way_home/return_proof.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/space/measured_space.h"
#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

constexpr double clearance = 2.0;

ReturnLaw law_of(std::vector<Dialect> dialects, double level, const Vector3d& pad = {0, 0, 0}) {
  return {.dialects = std::move(dialects), .level = level, .landings = {pad}};
}

/// A free-standing upright slab, whose face toward -x is at `x`.
Obstacles wall_at(double x, double height = 60.0) {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({x, -50, 0}, {x + 1, 50, height});
  return obstacles;
}

// The column over a place beside a wall keeps the distance that the place has; so does the whole
// return to a pad farther off.
TEST(ReturnProof, KeepsTheDistanceOfAColumnBesideAWall) {
  const ReturnLaw law = law_of({Dialect::px4}, 30.0, {-40, 0, 0});
  const Segment place{{0, 0, 10}, {0, 0, 10}};
  const KnownSpace enough(wall_at(2.0 + 1e-3, 20.0)), too_near(wall_at(2.0 - 1e-3, 20.0));
  const ReturnProof proof = prove_returns(enough, place, law, clearance);
  EXPECT_TRUE(proof.is_proven);
  EXPECT_NEAR(proof.clearance, 2.0 + 1e-3, 1e-5);
  EXPECT_FALSE(prove_returns(too_near, place, law, clearance).is_proven);
}

// A leg along a wall is proven to within the slack, and refused at less than the clearance.
TEST(ReturnProof, ProvesALegBesideAWallToWithinTheSlack) {
  const ReturnLaw law = law_of({Dialect::ardupilot}, 30.0, {-40, 0, 0});
  const Segment leg{{0, -20, 10}, {0, 20, 12}};
  const KnownSpace enough(wall_at(2.0 + return_slack + 1e-3, 20.0));
  const KnownSpace too_near(wall_at(2.0 - 1e-3, 20.0));
  const ReturnProof proof = prove_returns(enough, leg, law, clearance);
  EXPECT_TRUE(proof.is_proven);
  EXPECT_GE(proof.clearance, 2.0 - 1e-9);
  EXPECT_LE(proof.clearance, 2.0 + return_slack + 1e-3);
  EXPECT_FALSE(prove_returns(too_near, leg, law, clearance).is_proven);
}

TEST(ReturnProof, NamesThePieceThePlaceAndTheObstacle) {
  const KnownSpace space(wall_at(-20.0, 20.0));  // between the place and the pad
  const Segment place{{0, 0, 10}, {0, 0, 10}};
  const ReturnProof low =
      prove_returns(space, place, law_of({Dialect::px4}, 15.0, {-40, 0, 0}), clearance);
  ASSERT_FALSE(low.is_proven);
  EXPECT_THAT(describe(low, space),
              AllOf(HasSubstr("the level flight of the return from (0.00, 0.00, 10.00)"),
                    HasSubstr("within 0.000 m"), HasSubstr("triangle"), HasSubstr("14.60)")));
  EXPECT_TRUE(
      prove_returns(space, place, law_of({Dialect::px4}, 23.0, {-40, 0, 0}), clearance).is_proven);
}

// DJI's vehicles fly home level when near; with the wall between, no height of return helps them.
TEST(ReturnProof, RefusesALevelReturnOfDjiThroughAWallAtAnyHeight) {
  const KnownSpace space(wall_at(-20.0, 20.0));
  const Segment place{{0, 0, 10}, {0, 0, 10}};
  const ReturnLaw law = law_of({Dialect::dji}, 40.0, {-40, 0, 0});
  const ReturnProof near = prove_returns(space, place, law, clearance);
  EXPECT_FALSE(near.is_proven);
  EXPECT_EQ(near.piece.part, ReturnPart::level_as_it_is);
  const ReturnLaw far = law_of({Dialect::dji}, 40.0, {-60, 0, 0});
  EXPECT_TRUE(prove_returns(space, place, far, clearance).is_proven);
}

// Unknown is never free: over a place from which nobody has looked up there is no return.
TEST(ReturnProof, RefusesToClimbThroughWhatWasNeverSeen) {
  MeasuredSpaceConfig config;
  config.region = {Vector3d(-10, -10, 0), Vector3d(10, 10, 40)};
  MeasuredSpace space(config);
  space.declare_free(Eigen::AlignedBox3d(Vector3d(-10, -10, 0), Vector3d(10, 10, 20)));
  const Segment place{{0, 0, 10}, {0, 0, 10}};
  const ReturnLaw high = law_of({Dialect::px4}, 50.0, {-40, 0, 0});
  const ReturnProof proof = prove_returns(space, place, high, clearance);
  EXPECT_FALSE(proof.is_proven);
  EXPECT_EQ(proof.closest.kind, ObstacleKind::unknown_space);
  EXPECT_EQ(proof.piece.part, ReturnPart::climb);
  // Level through what was seen, and out of the box.
  const ReturnLaw low = law_of({Dialect::px4}, 15.0, {-40, 0, 0});
  EXPECT_TRUE(prove_returns(space, place, low, clearance).is_proven);
}

/// The distance of a return by brute force: a point every 20 cm, each asked for its own distance.
double sampled_distance(const FreeSpace& space, const std::vector<ReturnPiece>& pieces) {
  double least = std::numeric_limits<double>::infinity();
  for (const ReturnPiece& piece : pieces) {
    const int steps = 1 + static_cast<int>(piece.line.length() / 0.2);
    for (int i = 0; i <= steps; ++i) {
      const double distance = space.distance(piece.line.at(static_cast<double>(i) / steps), 20.0);
      least = std::min(least, distance - piece.spread);
    }
  }
  return least;
}

/// The pieces that an autopilot flies: of DJI's two ways home, either.
class RandomScenes : public testing::TestWithParam<int> {};

// No return from a point of a proven leg comes nearer than what was proven; and a leg that is
// refused has a return nearer than the slack above the clearance.
TEST_P(RandomScenes, ProofAgreesWithReturnsFromRandomPoints) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  Obstacles obstacles;
  obstacles.mesh = scenes::boxes(random, 12);
  obstacles.ground_height = -40.0;
  const KnownSpace space(obstacles);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int proven = 0, refused = 0;
  for (const Segment& leg :
       scenes::legs(random, 60, {Vector3d(-35, -35, -30), Vector3d(35, 35, 35)})) {
    const ReturnLaw law = law_of({Dialect::ardupilot, Dialect::px4, Dialect::dji},
                                 5.0 + 35.0 * share(random), {-55, -45, -40});
    const ReturnProof proof = prove_returns(space, leg, law, clearance);
    if (!proof.is_proven) {
      ++refused;
      const double near = sampled_distance(space, return_pieces(law, proof.from, return_slack));
      EXPECT_LE(near, clearance + return_slack + 0.11);  // samples are 20 cm apart
      continue;
    }
    ++proven;
    EXPECT_GE(proof.clearance, clearance - 1e-9);
    for (int i = 0; i < 20; ++i) {
      const Vector3d place = leg.at(share(random));
      ASSERT_GE(sampled_distance(space, return_pieces(law, place)), proof.clearance - 1e-6)
          << place.transpose();
    }
  }
  EXPECT_GT(proven, 5);
  EXPECT_GT(refused, 2);
}

INSTANTIATE_TEST_SUITE_P(ReturnProof, RandomScenes, testing::Range(1, 6));

}  // namespace
}  // namespace skycap::flight
