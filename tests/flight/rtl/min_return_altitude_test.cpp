#include "flight/rtl/min_return_altitude.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/measured_space.h"
#include "flight/route/route.h"
#include "flight/rtl/return_paths.h"
#include "geometry/error.h"
#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

constexpr double clearance = 2.0;

/// Returns a tower of 10 x 10 m between the position at y = 0 and the pad 60 m west of it.
Obstacles tower(double height) {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({-35, -5, 0}, {-25, 5, height});
  obstacles.ground_height = 0.0;
  return obstacles;
}

RtlProfile make_rtl_profile(std::vector<AutopilotType> autopilots) {
  return {.autopilots = std::move(autopilots), .landings = {{-60, 0, 0}}};
}

const std::vector<Segment> leg{{{0, 0, 10}, {0, 3, 12}}};

// Above a tower of 30 m with 2 m clearance, the middle of the altitude band must be slightly above
// 32 m. With bands of 2 and 0.8 m, the altitudes are 34 and 32.8 m, rounded up to whole metres.
TEST(MinReturnAltitude, IsSmallestWholeMetreAboveTower) {
  const KnownSpace space(tower(30.0));
  for (const auto& [autopilot, height] :
       {std::pair(AutopilotType::ardupilot, 35.0), std::pair(AutopilotType::px4, 33.0)}) {
    const ReturnSearch search =
        min_return_altitude(space, leg, make_rtl_profile({autopilot}), 60.0, clearance);
    ASSERT_TRUE(search.found) << search.reason;
    EXPECT_DOUBLE_EQ(search.found->height, height);
    EXPECT_GE(search.found->clearance, clearance);
    EXPECT_THAT(search.found->obstacle, HasSubstr("triangle"));
  }
}

// A route at 11.3 m, with obstacles below 5 m only. The return altitude is the next whole metre
// above the route. If the fence has a ceiling of 11.5 m, it is the altitude of the route.
TEST(MinReturnAltitude, IsNotBelowRoute) {
  const std::vector<Segment> high{{{0, 0, 11.3}, {0, 3, 11.3}}};
  Obstacles obstacles = tower(3.0);
  const ReturnSearch open = min_return_altitude(
      KnownSpace(obstacles), high, make_rtl_profile({AutopilotType::px4}), 5.0, clearance);
  ASSERT_TRUE(open.found) << open.reason;
  EXPECT_DOUBLE_EQ(open.found->height, 12.0);
  obstacles.fence = Prism{"site",
                          {{-90, -90}, {90, -90}, {90, 90}, {-90, 90}},
                          -5.0,
                          11.5 + clearance + px4_landing_radius};
  const ReturnSearch closed = min_return_altitude(
      KnownSpace(obstacles), high, make_rtl_profile({AutopilotType::px4}), 5.0, clearance);
  ASSERT_TRUE(closed.found) << closed.reason;
  EXPECT_DOUBLE_EQ(closed.found->height, 11.3);
  EXPECT_FALSE(min_return_altitude(KnownSpace(obstacles), high,
                                   make_rtl_profile({AutopilotType::dji}), 5.0, clearance)
                   .found);
}

// Trying all whole metres above the route gives the same result as the search.
TEST(MinReturnAltitude, MatchesSearchOverAllWholeMetres) {
  for (const double top : {8.0, 17.3, 24.0, 41.9}) {
    const KnownSpace space(tower(top));
    const ReturnSearch search =
        min_return_altitude(space, leg, make_rtl_profile({AutopilotType::px4}), 60.0, clearance);
    ASSERT_TRUE(search.found) << search.reason;
    const double max_height = std::max(leg.front().from.z(), leg.front().to.z());
    for (double height = std::ceil(max_height); height <= 60.0; height += 1.0) {
      RtlProfile rtl_profile = make_rtl_profile({AutopilotType::px4});
      rtl_profile.level = height;
      const bool is_safe = verify_returns(space, leg, rtl_profile, clearance).found.has_value();
      EXPECT_EQ(is_safe, height >= search.found->height) << height << " m over " << top << " m";
    }
  }
}

// The wall along the path leaves 1 cm more than the clearance. This is too little for balls of 5
// cm, which planned legs may touch, and enough for smaller ones. Less than the clearance is always
// rejected.
TEST(MinReturnAltitude, IsVerifiedWithLessRoomThanPlanningSlack) {
  const auto beside = [](double distance) {
    Obstacles obstacles;
    obstacles.ground_height = 0.0;
    obstacles.no_fly = {{"wall", {{-90, distance}, {90, distance}, {90, 90}, {-90, 90}}}};
    return KnownSpace(obstacles);
  };
  const std::vector<Segment> along{{{0, 0, 10}, {30, 0, 12}}};
  const RtlProfile rtl_profile = make_rtl_profile({AutopilotType::dji});
  ASSERT_EQ(rtl_profile.landings.front().y(), 0.0);
  const ReturnSearch near =
      min_return_altitude(beside(clearance + 0.01), along, rtl_profile, 60.0, clearance);
  ASSERT_TRUE(near.found) << near.reason;
  EXPECT_GE(near.found->clearance, clearance);
  EXPECT_LE(near.found->clearance, clearance + 0.01);
  EXPECT_FALSE(
      verify_returns(beside(clearance + 0.01), along.front(), near.found->rtl_profile, clearance)
          .is_verified);
  EXPECT_FALSE(
      min_return_altitude(beside(clearance - 0.01), along, rtl_profile, 60.0, clearance).found);
}

// A no-fly zone of unlimited height separates the route from the pad. The return goes to a rally
// point on this side.
TEST(MinReturnAltitude, UsesRallyPointWhenPadIsUnreachable) {
  Obstacles obstacles;
  obstacles.ground_height = 0.0;
  obstacles.no_fly = {{"airport", {{-35, -90}, {-25, -90}, {-25, 90}, {-35, 90}}}};
  const KnownSpace space(obstacles);
  RtlProfile rtl_profile = make_rtl_profile({AutopilotType::px4, AutopilotType::ardupilot});
  const ReturnSearch none = min_return_altitude(space, leg, rtl_profile, 60.0, clearance);
  EXPECT_FALSE(none.found) << none.found->height << " m, " << none.found->clearance << " m from "
                           << none.found->obstacle;
  rtl_profile.landings.emplace_back(15, 0, 0);
  const ReturnSearch search = min_return_altitude(space, leg, rtl_profile, 60.0, clearance);
  ASSERT_TRUE(search.found) << search.reason;
  EXPECT_GE(search.found->clearance, clearance);
  rtl_profile.landings.back() = {-23.5, 0, 0};  // 1.5 m from the airport
  EXPECT_FALSE(min_return_altitude(space, leg, rtl_profile, 60.0, clearance).found);
}

TEST(MinReturnAltitude, NamesObstacleWhenCeilingIsTooLow) {
  Obstacles obstacles = tower(30.0);
  obstacles.fence = Prism{"site", {{-90, -90}, {90, -90}, {90, 90}, {-90, 90}}, -1.0, 33.0};
  const KnownSpace space(obstacles);
  const ReturnSearch search =
      min_return_altitude(space, leg, make_rtl_profile({AutopilotType::px4}), 60.0, clearance);
  EXPECT_FALSE(search.found);
  EXPECT_THAT(search.reason, AllOf(HasSubstr("at a return altitude of 60 m"), HasSubstr("fence")));
}

// DJI's applications accept 20 m or more.
TEST(MinReturnAltitude, IsTwentyMetresOrMoreForDji) {
  const KnownSpace space(tower(1.0));
  const ReturnSearch search =
      min_return_altitude(space, leg, make_rtl_profile({AutopilotType::dji}), 60.0, clearance);
  ASSERT_TRUE(search.found) << search.reason;
  EXPECT_DOUBLE_EQ(search.found->height, 20.0);
}

/// Returns the measured space of a box of 40 x 40 x 30 m. Only the part below 15 m and a shaft at
/// the edge were observed as free.
MeasuredSpace cellar() {
  MeasuredSpaceConfig config;
  config.voxel = 0.5;
  config.region = {Vector3d(-20, -20, 0), Vector3d(20, 20, 30)};
  MeasuredSpace space(config);
  space.declare_free(Eigen::AlignedBox3d(Vector3d(-20, -20, 0), Vector3d(20, 20, 15)));
  space.declare_free(Eigen::AlignedBox3d(Vector3d(8, -20, 0), Vector3d(20, 20, 30)));
  return space;
}

RouteOptions options_with_returns() {
  RouteOptions options;
  options.takeoff = {40, 0, 0};
  options.returns = ReturnOptions{{AutopilotType::px4}, 36.0};
  return options;
}

// Below unobserved space there is no return path. The capture point is reported with this reason.
TEST(ReturnPaths, OmitCapturePointsUnderUnknownSpace) {
  const MeasuredSpace measured = cellar();
  Obstacles rules;
  rules.ground_height = 0.0;
  const KnownSpace known(rules);
  const JointSpace space({&measured, &known});
  const std::vector<CapturePoint> capture_points{
      {geometry::look_at({14, 0, 8}, {0, 0, 8}), 1.0, 1, 5},
      {geometry::look_at({0, 0, 8}, {5, 0, 8}), 1.0, 1, 6}};
  RouteOptions options = options_with_returns();
  // A return at 13 m would be free, but routes are planned with the maximum return altitude.
  const Route route = plan_route(capture_points, {}, space, nullptr, options);
  ASSERT_EQ(route.capture_points.size(), 1U);
  ASSERT_EQ(route.unreached.size(), 1U);
  EXPECT_EQ(route.unreached[0].capture_point.view_index, 6U);
  EXPECT_THAT(route.unreached[0].reason,
              AllOf(HasSubstr("no verified return"), HasSubstr("the climb"),
                    HasSubstr("unobserved space")));
  ASSERT_TRUE(route.returns);
  EXPECT_GE(route.returns->clearance, route.clearance - return_slack);
  options.returns.reset();
  EXPECT_EQ(plan_route(capture_points, {}, space, nullptr, options).capture_points.size(), 2U);
}

// The straight leg between two shafts passes below unobserved space, so the planned leg goes over
// it.
TEST(ReturnPaths, KeepLegsWhereEveryPointHasVerifiedReturn) {
  MeasuredSpace measured = cellar();
  measured.declare_free(Eigen::AlignedBox3d(Vector3d(-20, -20, 0), Vector3d(-8, 20, 30)));
  Obstacles rules;
  rules.ground_height = 0.0;
  const KnownSpace known(rules);
  const JointSpace space({&measured, &known});
  const std::vector<CapturePoint> capture_points{
      {geometry::look_at({14, 0, 8}, {0, 0, 8}), 1.0, 1, 0},
      {geometry::look_at({-14, 0, 8}, {0, 0, 8}), 1.0, 1, 1}};
  const Route route = plan_route(capture_points, {}, space, nullptr, options_with_returns());
  ASSERT_EQ(route.capture_points.size(), 2U);
  ASSERT_TRUE(route.returns);
  EXPECT_TRUE(check_route(sortie_points(route, route.sorties[0]), space, route.clearance).empty());
  const std::vector<Vector3d>& points = route.legs[0].points;
  ASSERT_GT(points.size(), 1U);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_TRUE(verify_returns(space, {points[i - 1], points[i]}, route.returns->rtl_profile,
                               route.clearance - return_slack)
                    .is_verified);
  }
  // The climb above 32 m and the descent take 28 + 48 m. No path is much shorter.
  EXPECT_LT(route.legs[0].length, 80.0);
  EXPECT_GT(route.legs[0].length, 28.0);
}

// The path with returns is longer by half. For any battery, each view is flown or reported. One
// view that has become too distant does not discard the others.
TEST(ReturnPaths, ReportViewsOutOfBatteryRange) {
  MeasuredSpace measured = cellar();
  measured.declare_free(Eigen::AlignedBox3d(Vector3d(-20, -20, 0), Vector3d(-8, 20, 30)));
  Obstacles rules;
  rules.ground_height = 0.0;
  const KnownSpace known(rules);
  const JointSpace space({&measured, &known});
  const std::vector<CapturePoint> capture_points{
      {geometry::look_at({14, 0, 8}, {0, 0, 8}), 1.0, 1, 0},
      {geometry::look_at({-14, 0, 8}, {0, 0, 8}), 1.0, 1, 1}};
  int left_out = 0;
  for (double battery = 4.0; battery < 24.0; battery += 0.25) {
    Vehicle vehicle;
    vehicle.battery_wh = battery;
    vehicle.endurance_min = 0.3 * battery;
    RouteOptions options = options_with_returns();
    options.conditions.longest_flight = 1.5;
    const double usable = Motion(vehicle, options.conditions).usable_energy();
    const Route route = plan_route(capture_points, vehicle, space, nullptr, options);
    EXPECT_EQ(route.capture_points.size() + route.unreached.size(), 2U) << battery << " Wh";
    EXPECT_EQ(route.sorties.empty(), route.capture_points.empty()) << battery << " Wh";
    for (const Sortie& sortie : route.sorties) EXPECT_LE(1.5 * sortie.energy, usable);
    if (route.capture_points.size() != 1) continue;
    ++left_out;
    EXPECT_EQ(route.unreached[0].capture_point.view_index, 1U);
    EXPECT_THAT(route.unreached[0].reason, HasSubstr("Wh above its reserve"));
  }
  EXPECT_GT(left_out, 2);
}

TEST(ReturnPaths, RejectCapturePointsWithoutVerifiedReturnAltitude) {
  Obstacles obstacles = tower(30.0);
  obstacles.fence = Prism{"site", {{-90, -90}, {90, -90}, {90, 90}, {-90, 90}}, -1.0, 33.0};
  const KnownSpace space(obstacles);
  RouteOptions options;
  options.takeoff = {-60, 0, 0};
  options.returns = ReturnOptions{{AutopilotType::px4}, 31.0};
  const std::vector<CapturePoint> capture_points{
      {geometry::look_at({0, 0, 10}, {-30, 0, 10}), 1.0, 1, 3}};
  const Route route = plan_route(capture_points, {}, space, nullptr, options);
  EXPECT_TRUE(route.sorties.empty());
  ASSERT_EQ(route.unreached.size(), 1U);
  EXPECT_THAT(route.unreached[0].reason,
              AllOf(HasSubstr("no verified return"), HasSubstr("the level flight")));
}

// A shortened path ends where another rule begins, at the 50 m within which DJI vehicles return
// level. The route verification divides its legs differently and must still succeed.
TEST(ReturnPaths, AreVerifiedAtDjiLevelReturnDistance) {
  RouteOptions options;
  options.takeoff = {-60, 0, 0};
  options.returns = ReturnOptions{{AutopilotType::dji}, 36.0};
  options.order_is_free = true;
  const KnownSpace space(tower(30.0));
  std::mt19937 random(1);
  const auto within = [&](double low, double high) {
    return low + (high - low) * 0x1p-32 * static_cast<double>(random());
  };
  std::size_t reached = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<CapturePoint> capture_points;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const double bearing = within(-0.5, 0.5), distance = within(50.0, 70.0);
      const Vector3d position(-60.0 + distance * std::cos(bearing), distance * std::sin(bearing),
                              within(5.0, i == 0 ? 45.0 : 30.0));
      capture_points.push_back({geometry::look_at(position, {-30, 0, position.z()}), 1.0, 1, i});
    }
    const Route route = plan_route(capture_points, {}, space, nullptr, options);
    ASSERT_TRUE(route.returns || route.capture_points.empty());
    reached += route.capture_points.size();
  }
  EXPECT_GT(reached, 80U);
}

// Computed by hand for still air: climb and level flight, plus hover for the waits and the descent.
TEST(ReturnEnergy, IsSumOfSegmentsAndWaits) {
  const Motion motion({}, {});
  RtlProfile rtl_profile = make_rtl_profile({AutopilotType::px4});
  rtl_profile.level = 30.0;
  const auto energy = [&](const Vector3d& displacement) {
    return motion.leg_energy(displacement, motion.leg_time(displacement));
  };
  const double segments = energy({0, 0, 20}) + energy({-60, 0, 0});
  const double landing = motion.landing_time(30.0);
  const double total = return_energy(motion, rtl_profile, {0, 0, 10});
  EXPECT_GT(total, segments + motion.hover_energy(landing + 10.0));
  EXPECT_LT(total, segments + motion.hover_energy(landing + 20.0));
}

}  // namespace
}  // namespace skycap::flight
