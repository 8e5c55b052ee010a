#include "flight/rtl/rtl_profile.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/not_empty.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::Each;
using testing::Field;
using testing::SizeIs;

constexpr double level = 40.0;

RtlProfile make_rtl_profile(std::vector<AutopilotType> autopilots) {
  return {.autopilots = std::move(autopilots), .level = level, .landings = {{0, 0, 1}}};
}

const ReturnSegment* find(const std::vector<ReturnSegment>& segments, ReturnPart part) {
  const auto found = std::ranges::find(segments, part, &ReturnSegment::part);
  return found == segments.end() ? nullptr : &*found;
}

void expect_line(const ReturnSegment* segment, const Vector3d& from, const Vector3d& to,
                 double spread) {
  ASSERT_NE(segment, nullptr);
  EXPECT_TRUE(segment->line.from.isApprox(from)) << segment->line.from.transpose();
  EXPECT_TRUE(segment->line.to.isApprox(to)) << segment->line.to.transpose();
  EXPECT_DOUBLE_EQ(segment->spread, spread);
}

// Calculated by hand from mode_rtl.cpp with RTL_ALT 40, RTL_CONE_SLOPE 0: climb at the position,
// level flight at 40. The corner is cut by at most 2 m, so the band is 38 to 40.
TEST(RtlProfile, HasClimbAndTwoMetreLevelBandForArduCopter) {
  const auto segments = return_segments(make_rtl_profile({AutopilotType::ardupilot}), {30, 40, 12});
  ASSERT_THAT(segments, SizeIs(2));
  expect_line(find(segments, ReturnPart::climb), {30, 40, 12}, {30, 40, 40}, 0.0);
  expect_line(find(segments, ReturnPart::level), {30, 40, 39}, {0, 0, 39}, 1.0);
}

// rtl_direct.cpp: the climb ends NAV_MC_ALT_RAD = 0.8 below its target, and the descent starts
// within NAV_ACC_RAD = 1 of the landing point.
TEST(RtlProfile, HasLevelBandAndLandingRadiusForPx4) {
  const RtlProfile rtl_profile = make_rtl_profile({AutopilotType::px4});
  const auto segments = return_segments(rtl_profile, {3, 4, 12});
  ASSERT_THAT(segments, SizeIs(2));
  expect_line(find(segments, ReturnPart::level), {3, 4, 39.6}, {0, 0, 39.6}, 0.4);
  const auto columns = landing_columns(rtl_profile, 50.0);
  ASSERT_THAT(columns, SizeIs(1));
  expect_line(columns.data(), {0, 0, 50}, {0, 0, 6}, 1.0);
}

struct DjiCase {
  double distance;
  bool may_stay_level, may_land;
};

// According to the manuals, the vehicle climbs first beyond 50 m. From 5 to 50 m it may return at
// its current altitude. Within 5 m it may land on the spot. A tolerance of three metres is added to
// both distances.
TEST(RtlProfile, HasLevelAndLandingDistancesForDji) {
  for (const DjiCase& expected :
       {DjiCase{60, false, false}, DjiCase{53.1, false, false}, DjiCase{52.9, true, false},
        DjiCase{20, true, false}, DjiCase{8.1, true, false}, DjiCase{7.9, true, true},
        DjiCase{0, true, true}}) {
    const auto segments =
        return_segments(make_rtl_profile({AutopilotType::dji}), {expected.distance, 0, 12});
    const ReturnSegment* as_it_is = find(segments, ReturnPart::level_as_it_is);
    EXPECT_EQ(as_it_is != nullptr, expected.may_stay_level) << expected.distance;
    EXPECT_EQ(find(segments, ReturnPart::landing) != nullptr, expected.may_land)
        << expected.distance;
    if (as_it_is != nullptr) expect_line(as_it_is, {expected.distance, 0, 12}, {0, 0, 12}, 0.0);
    expect_line(find(segments, ReturnPart::climb), {expected.distance, 0, 12},
                {expected.distance, 0, 40}, 0.0);
  }
}

TEST(RtlProfile, KeepsHeightAboveReturnAltitude) {
  const auto segments = return_segments(make_rtl_profile({AutopilotType::px4}), {30, 40, 70});
  expect_line(find(segments, ReturnPart::climb), {30, 40, 70}, {30, 40, 70}, 0.0);
  expect_line(find(segments, ReturnPart::level), {30, 40, 69.6}, {0, 0, 69.6}, 0.4);
}

TEST(RtlProfile, UsesNearestLandingOrBothWhenAmbiguous) {
  RtlProfile rtl_profile = make_rtl_profile({AutopilotType::ardupilot});
  rtl_profile.landings.emplace_back(100, 0, 3);
  EXPECT_THAT(return_segments(rtl_profile, {30, 0, 10}), SizeIs(2));
  EXPECT_THAT(return_segments(rtl_profile, {80, 0, 10}), SizeIs(2));
  expect_line(find(return_segments(rtl_profile, {80, 0, 10}), ReturnPart::level), {80, 0, 39},
              {100, 0, 39}, 1.0);
  EXPECT_THAT(return_segments(rtl_profile, {52, 0, 10}),
              SizeIs(3));  // distances 48 and 52 m differ by less than 10 m
  EXPECT_THAT(return_segments(rtl_profile, {30, 0, 10}, 20.0),
              SizeIs(3));  // from positions within 20 m, the other landing may be closer
}

// The autopilot decides before it brakes: 12 m from the start, the other landing is as close.
TEST(RtlProfile, CoversDecisionsBeforeBraking) {
  RtlProfile rtl_profile = make_rtl_profile({AutopilotType::ardupilot});
  rtl_profile.landings.emplace_back(100, 0, 3);
  EXPECT_THAT(return_segments(rtl_profile, {62, 0, 10}), SizeIs(2));
  rtl_profile.braking = 12.0;
  EXPECT_THAT(return_segments(rtl_profile, {62, 0, 10}), SizeIs(3));
  EXPECT_THAT(return_segments(rtl_profile, {63, 0, 10}), SizeIs(2));

  RtlProfile dji = make_rtl_profile({AutopilotType::dji});
  dji.braking = 7.7;
  EXPECT_NE(find(return_segments(dji, {57.9, 0, 12}), ReturnPart::level_as_it_is), nullptr);
  EXPECT_EQ(find(return_segments(dji, {58.1, 0, 12}), ReturnPart::level_as_it_is), nullptr);
}

/// Returns the distance of the points of `segment` from the nearest segment of the same part. Ends
/// are compared with ends.
double distance_to_counterpart(const ReturnSegment& segment,
                               const std::vector<ReturnSegment>& others) {
  double nearest = 1e9;
  for (const ReturnSegment& other : others) {
    if (other.part != segment.part || other.spread != segment.spread) continue;
    nearest = std::min(nearest, std::max((other.line.from - segment.line.from).norm(),
                                         (other.line.to - segment.line.to).norm()));
  }
  return nearest;
}

// Property on which the verification is based: all returns from positions within the reach are
// within the same distance of the returns computed for that reach.
TEST(RtlProfile, IsOneLipschitzInStartPosition) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> coordinate(-80, 80), height(5, 60), unit(-1, 1);
  RtlProfile rtl_profile =
      make_rtl_profile({AutopilotType::ardupilot, AutopilotType::px4, AutopilotType::dji});
  rtl_profile.landings.emplace_back(60, -20, 4);
  for (int i = 0; i < 20000; ++i) {
    const Vector3d a{coordinate(random), coordinate(random), height(random)};
    const Vector3d b = a + 15.0 * Vector3d{unit(random), unit(random), unit(random)};
    const double apart = (b - a).norm();
    const auto around = return_segments(rtl_profile, a, apart + 1e-12);
    for (const ReturnSegment& segment :
         testing_support::not_empty(return_segments(rtl_profile, b))) {
      ASSERT_LE(distance_to_counterpart(segment, around), apart + 1e-9)
          << to_string(segment.part) << " from " << b.transpose() << " and " << a.transpose();
    }
  }
}

}  // namespace
}  // namespace skycap::flight
