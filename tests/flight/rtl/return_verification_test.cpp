#include "flight/rtl/return_verification.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/measured_space.h"
#include "flight/flight_options.h"
#include "flight/route/route.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

constexpr double clearance = 2.0;

RtlProfile make_rtl_profile(std::vector<AutopilotType> autopilots, double level,
                            const Vector3d& pad = {0, 0, 0}) {
  return {.autopilots = std::move(autopilots), .level = level, .landings = {pad}};
}

/// Returns a free-standing vertical slab with a face towards -x at `x`.
Obstacles wall_at(double x, double height = 60.0) {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({x, -50, 0}, {x + 1, 50, height});
  return obstacles;
}

// The column above a position near a wall has the same distance from it as the position. The same
// applies to the return to a pad farther away.
TEST(ReturnVerification, ComputesClearanceOfReturnAlongWall) {
  const RtlProfile rtl_profile = make_rtl_profile({AutopilotType::px4}, 30.0, {-40, 0, 0});
  const Segment position{{0, 0, 10}, {0, 0, 10}};
  const KnownSpace enough(wall_at(2.0 + 1e-3, 20.0)), too_near(wall_at(2.0 - 1e-3, 20.0));
  const ReturnVerification verification = verify_returns(enough, position, rtl_profile, clearance);
  EXPECT_TRUE(verification.is_verified);
  EXPECT_NEAR(verification.clearance, 2.0 + 1e-3, 1e-5);
  EXPECT_FALSE(verify_returns(too_near, position, rtl_profile, clearance).is_verified);
}

// Over unknown space, the altitude for which routes are planned is sufficient whatever the height
// of its top: rounding to whole metres and voxels, and autopilots that fly lower, are included.
TEST(ReturnVerification, VerifiesReturnsOverUnknownSpaceOfAnyHeight) {
  FlightOptions options{.vehicle = vehicle_profile("m350_rtk"), .clearance = clearance};
  const Vector3d pad(-70, 0, 0);
  for (int centimetres = 2000; centimetres <= 2100; centimetres += 3) {
    const double top = 0.01 * centimetres;
    options.unknown_box = {Vector3d(-10, -10, 0), Vector3d(10, 10, top)};
    options.extra_unknown_boxes.assign(1, {Vector3d(-40, -5, 0), Vector3d(-30, 5, top + 1.5)});
    const MeasuredSpace space(options.measured_space());
    const RtlProfile rtl_profile = planning_rtl_profile(options.route(pad), pad.z());
    const Segment leg{{20, -5, 15}, {20, 5, 18}};
    EXPECT_TRUE(verify_returns(space, leg, rtl_profile, return_clearance(clearance)).is_verified)
        << top;
  }
}

// A leg along a wall is verified within the slack and rejected below the clearance.
TEST(ReturnVerification, AcceptsLegAlongWallWithinSlack) {
  const RtlProfile rtl_profile = make_rtl_profile({AutopilotType::ardupilot}, 30.0, {-40, 0, 0});
  const Segment leg{{0, -20, 10}, {0, 20, 12}};
  const KnownSpace enough(wall_at(2.0 + return_slack + 1e-3, 20.0));
  const KnownSpace too_near(wall_at(2.0 - 1e-3, 20.0));
  const ReturnVerification verification = verify_returns(enough, leg, rtl_profile, clearance);
  EXPECT_TRUE(verification.is_verified);
  EXPECT_GE(verification.clearance, 2.0 - 1e-9);
  EXPECT_LE(verification.clearance, 2.0 + return_slack + 1e-3);
  EXPECT_FALSE(verify_returns(too_near, leg, rtl_profile, clearance).is_verified);
}

TEST(ReturnVerification, ReportsSegmentPositionAndObstacle) {
  const KnownSpace space(wall_at(-20.0, 20.0));  // Between the position and the pad.
  const Segment position{{0, 0, 10}, {0, 0, 10}};
  const ReturnVerification low = verify_returns(
      space, position, make_rtl_profile({AutopilotType::px4}, 15.0, {-40, 0, 0}), clearance);
  ASSERT_FALSE(low.is_verified);
  EXPECT_THAT(describe(low, space),
              AllOf(HasSubstr("the level flight of the return from (0.00, 0.00, 10.00)"),
                    HasSubstr("within 0.000 m"), HasSubstr("triangle"), HasSubstr("14.60)")));
  EXPECT_TRUE(verify_returns(space, position,
                             make_rtl_profile({AutopilotType::px4}, 23.0, {-40, 0, 0}), clearance)
                  .is_verified);
}

// DJI vehicles near the pad return at their current altitude. With the wall between, no return
// altitude avoids it.
TEST(ReturnVerification, RejectsDjiLevelReturnThroughWall) {
  const KnownSpace space(wall_at(-20.0, 20.0));
  const Segment position{{0, 0, 10}, {0, 0, 10}};
  const RtlProfile rtl_profile = make_rtl_profile({AutopilotType::dji}, 40.0, {-40, 0, 0});
  const ReturnVerification near = verify_returns(space, position, rtl_profile, clearance);
  EXPECT_FALSE(near.is_verified);
  EXPECT_EQ(near.segment.part, ReturnPart::level_as_it_is);
  const RtlProfile far = make_rtl_profile({AutopilotType::dji}, 40.0, {-60, 0, 0});
  EXPECT_TRUE(verify_returns(space, position, far, clearance).is_verified);
}

// Unknown space is not free: above a position without measured space no return is verified.
TEST(ReturnVerification, RejectsClimbThroughUnobservedSpace) {
  MeasuredSpaceConfig config;
  config.region = {Vector3d(-10, -10, 0), Vector3d(10, 10, 40)};
  MeasuredSpace space(config);
  space.declare_free(Eigen::AlignedBox3d(Vector3d(-10, -10, 0), Vector3d(10, 10, 20)));
  const Segment position{{0, 0, 10}, {0, 0, 10}};
  const RtlProfile high = make_rtl_profile({AutopilotType::px4}, 50.0, {-40, 0, 0});
  const ReturnVerification verification = verify_returns(space, position, high, clearance);
  EXPECT_FALSE(verification.is_verified);
  EXPECT_EQ(verification.closest.kind, ObstacleKind::unknown_space);
  EXPECT_EQ(verification.segment.part, ReturnPart::climb);
  // Level flight through measured space and out of the box.
  const RtlProfile low = make_rtl_profile({AutopilotType::px4}, 15.0, {-40, 0, 0});
  EXPECT_TRUE(verify_returns(space, position, low, clearance).is_verified);
}

/// Returns the distance of a return by brute force, from one query every 20 cm.
double sampled_distance(const FreeSpace& space, const std::vector<ReturnSegment>& segments) {
  double min = std::numeric_limits<double>::infinity();
  for (const ReturnSegment& segment : segments) {
    const int steps = 1 + static_cast<int>(segment.line.length() / 0.2);
    for (int i = 0; i <= steps; ++i) {
      const double distance = space.distance(segment.line.at(static_cast<double>(i) / steps), 20.0);
      min = std::min(min, distance - segment.spread);
    }
  }
  return min;
}

/// Returns the segments that an autopilot flies, for either of DJI's two returns.
class RandomSceneReturnVerification : public testing::TestWithParam<int> {};

// No return from a verified leg comes closer than the verified distance. A rejected leg has a
// return closer than the clearance plus the slack.
TEST_P(RandomSceneReturnVerification, MatchesSampledReturns) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  Obstacles obstacles;
  obstacles.mesh = scenes::boxes(random, 12);
  obstacles.ground_height = -40.0;
  const KnownSpace space(obstacles);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int verified = 0, rejected = 0;
  for (const Segment& leg :
       scenes::legs(random, 60, {Vector3d(-35, -35, -30), Vector3d(35, 35, 35)})) {
    const RtlProfile rtl_profile =
        make_rtl_profile({AutopilotType::ardupilot, AutopilotType::px4, AutopilotType::dji},
                         5.0 + 35.0 * share(random), {-55, -45, -40});
    const ReturnVerification verification = verify_returns(space, leg, rtl_profile, clearance);
    if (!verification.is_verified) {
      ++rejected;
      const double near =
          sampled_distance(space, return_segments(rtl_profile, verification.from, return_slack));
      EXPECT_LE(near, clearance + return_slack + 0.11);  // Samples are 20 cm apart.
      continue;
    }
    ++verified;
    EXPECT_GE(verification.clearance, clearance - 1e-9);
    for (int i = 0; i < 20; ++i) {
      const Vector3d position = leg.at(share(random));
      ASSERT_GE(sampled_distance(space, return_segments(rtl_profile, position)),
                verification.clearance - 1e-6)
          << position.transpose();
    }
  }
  EXPECT_GT(verified, 5);
  EXPECT_GT(rejected, 2);
}

INSTANTIATE_TEST_SUITE_P(ReturnVerification, RandomSceneReturnVerification, testing::Range(1, 6));

}  // namespace
}  // namespace skycap::flight
