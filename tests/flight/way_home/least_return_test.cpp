#include "flight/way_home/least_return.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/route/route.h"
#include "flight/space/measured_space.h"
#include "flight/way_home/ways_home.h"
#include "geometry/error.h"
#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

constexpr double clearance = 2.0;

/// A tower, 10 x 10 m, between a place at y = 0 and the pad 60 m to the west of it.
Obstacles tower(double height) {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({-35, -5, 0}, {-25, 5, height});
  obstacles.ground_height = 0.0;
  return obstacles;
}

ReturnLaw law_of(std::vector<Dialect> dialects) {
  return {.dialects = std::move(dialects), .landings = {{-60, 0, 0}}};
}

const std::vector<Segment> leg{{{0, 0, 10}, {0, 3, 12}}};

// Over a tower of 30 m at 2 m the middle of the band must pass at 32 m and a bit: with bands of 2
// and 0.8 m the heights are 34 and 32.8, and whole metres above that.
TEST(LeastReturn, PassesOverATowerAtTheLeastWholeMetre) {
  const KnownSpace space(tower(30.0));
  for (const auto& [dialect, height] :
       {std::pair(Dialect::ardupilot, 35.0), std::pair(Dialect::px4, 33.0)}) {
    const ReturnSearch search = least_return(space, leg, law_of({dialect}), 60.0, clearance);
    ASSERT_TRUE(search.found) << search.why;
    EXPECT_DOUBLE_EQ(search.found->height, height);
    EXPECT_GE(search.found->clearance, clearance);
    EXPECT_THAT(search.found->obstacle, HasSubstr("triangle"));
  }
}

// A route at 11.3 m where nothing above 5 m is looked for: the metre above it, or, under a fence's
// ceiling that leaves 11.5 m, its own height.
TEST(LeastReturn, IsNoLowerThanTheRouteItself) {
  const std::vector<Segment> high{{{0, 0, 11.3}, {0, 3, 11.3}}};
  Obstacles obstacles = tower(3.0);
  const ReturnSearch open =
      least_return(KnownSpace(obstacles), high, law_of({Dialect::px4}), 5.0, clearance);
  ASSERT_TRUE(open.found) << open.why;
  EXPECT_DOUBLE_EQ(open.found->height, 12.0);
  obstacles.fence = Prism{"site",
                          {{-90, -90}, {90, -90}, {90, 90}, {-90, 90}},
                          -5.0,
                          11.5 + clearance + px4_landing_radius};
  const ReturnSearch closed =
      least_return(KnownSpace(obstacles), high, law_of({Dialect::px4}), 5.0, clearance);
  ASSERT_TRUE(closed.found) << closed.why;
  EXPECT_DOUBLE_EQ(closed.found->height, 11.3);
  EXPECT_FALSE(
      least_return(KnownSpace(obstacles), high, law_of({Dialect::dji}), 5.0, clearance).found);
}

// All whole metres above the route tried one after the other give the same answer as the search.
TEST(LeastReturn, IsTheFirstHeightThatIsProven) {
  for (const double top : {8.0, 17.3, 24.0, 41.9}) {
    const KnownSpace space(tower(top));
    const ReturnSearch search = least_return(space, leg, law_of({Dialect::px4}), 60.0, clearance);
    ASSERT_TRUE(search.found) << search.why;
    const double highest = std::max(leg.front().from.z(), leg.front().to.z());
    for (double height = std::ceil(highest); height <= 60.0; height += 1.0) {
      ReturnLaw law = law_of({Dialect::px4});
      law.level = height;
      const bool is_safe = prove_returns(space, leg, law, clearance).found.has_value();
      EXPECT_EQ(is_safe, height >= search.found->height) << height << " m over " << top << " m";
    }
  }
}

// A wall beside the whole way keeps 1 cm more than is asked for: too little for balls of 5 cm,
// which planned legs may meet, and enough for smaller ones. At less than is asked for nothing
// helps.
TEST(LeastReturn, IsProvenWhereTheRoomIsLessThanTheSlackOfPlanning) {
  const auto beside = [](double distance) {
    Obstacles obstacles;
    obstacles.ground_height = 0.0;
    obstacles.no_fly = {{"wall", {{-90, distance}, {90, distance}, {90, 90}, {-90, 90}}}};
    return KnownSpace(obstacles);
  };
  const std::vector<Segment> along{{{0, 0, 10}, {30, 0, 12}}};
  const ReturnLaw law = law_of({Dialect::dji});
  ASSERT_EQ(law.landings.front().y(), 0.0);
  const ReturnSearch near = least_return(beside(clearance + 0.01), along, law, 60.0, clearance);
  ASSERT_TRUE(near.found) << near.why;
  EXPECT_GE(near.found->clearance, clearance);
  EXPECT_LE(near.found->clearance, clearance + 0.01);
  EXPECT_FALSE(
      prove_returns(beside(clearance + 0.01), along.front(), near.found->law, clearance).is_proven);
  EXPECT_FALSE(least_return(beside(clearance - 0.01), along, law, 60.0, clearance).found);
}

// Airspace that is forbidden up to any height lies between the route and the pad: nobody returns
// over it, but to a rally point on this side.
TEST(LeastReturn, RallyPointsServeWhereThePadCannot) {
  Obstacles obstacles;
  obstacles.ground_height = 0.0;
  obstacles.no_fly = {{"airport", {{-35, -90}, {-25, -90}, {-25, 90}, {-35, 90}}}};
  const KnownSpace space(obstacles);
  ReturnLaw law = law_of({Dialect::px4, Dialect::ardupilot});
  const ReturnSearch none = least_return(space, leg, law, 60.0, clearance);
  EXPECT_FALSE(none.found) << none.found->height << " m, " << none.found->clearance << " m from "
                           << none.found->obstacle;
  law.landings.emplace_back(15, 0, 0);
  const ReturnSearch search = least_return(space, leg, law, 60.0, clearance);
  ASSERT_TRUE(search.found) << search.why;
  EXPECT_GE(search.found->clearance, clearance);
  law.landings.back() = {-23.5, 0, 0};  // 1.5 m beside the airport
  EXPECT_FALSE(least_return(space, leg, law, 60.0, clearance).found);
}

TEST(LeastReturn, SaysWhatIsInTheWayUnderACeilingThatIsTooLow) {
  Obstacles obstacles = tower(30.0);
  obstacles.fence = Prism{"site", {{-90, -90}, {90, -90}, {90, 90}, {-90, 90}}, -1.0, 33.0};
  const KnownSpace space(obstacles);
  const ReturnSearch search = least_return(space, leg, law_of({Dialect::px4}), 60.0, clearance);
  EXPECT_FALSE(search.found);
  EXPECT_THAT(search.why, AllOf(HasSubstr("at a return altitude of 60 m"), HasSubstr("fence")));
}

// DJI's applications take 20 m or more.
TEST(LeastReturn, IsAtLeastTwentyMetresForDji) {
  const KnownSpace space(tower(1.0));
  const ReturnSearch search = least_return(space, leg, law_of({Dialect::dji}), 60.0, clearance);
  ASSERT_TRUE(search.found) << search.why;
  EXPECT_DOUBLE_EQ(search.found->height, 20.0);
}

/// Of a box of 40 x 40 x 30 m only what is below 15 m was seen free, but for a shaft at its edge.
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
  options.returns = ReturnOptions{{Dialect::px4}, 36.0};
  return options;
}

// Where nobody has looked up there is no way home, and the station is named with the reason.
TEST(WaysHome, StationsUnderUnknownSpaceAreLeftOut) {
  const MeasuredSpace measured = cellar();
  Obstacles rules;
  rules.ground_height = 0.0;
  const KnownSpace known(rules);
  const JointSpace space({&measured, &known});
  const std::vector<Station> stations{{geometry::look_at({14, 0, 8}, {0, 0, 8}), 1.0, 1, 5},
                                      {geometry::look_at({0, 0, 8}, {5, 0, 8}), 1.0, 1, 6}};
  RouteOptions options = options_with_returns();
  // A return at 13 m would be free, but routes are planned for the greatest height.
  const Route route = plan_route(stations, {}, space, nullptr, options);
  ASSERT_EQ(route.stations.size(), 1U);
  ASSERT_EQ(route.unreached.size(), 1U);
  EXPECT_EQ(route.unreached[0].station.view_index, 6U);
  EXPECT_THAT(route.unreached[0].reason,
              AllOf(HasSubstr("no verified return"), HasSubstr("the climb"),
                    HasSubstr("unobserved space")));
  ASSERT_TRUE(route.returns);
  EXPECT_GE(route.returns->clearance, route.clearance - return_slack);
  options.returns.reset();
  EXPECT_EQ(plan_route(stations, {}, space, nullptr, options).stations.size(), 2U);
}

// The straight leg between two shafts leads under what nobody has seen: it goes over it instead.
TEST(WaysHome, LegsLeadWhereEveryPointHasAWayHome) {
  MeasuredSpace measured = cellar();
  measured.declare_free(Eigen::AlignedBox3d(Vector3d(-20, -20, 0), Vector3d(-8, 20, 30)));
  Obstacles rules;
  rules.ground_height = 0.0;
  const KnownSpace known(rules);
  const JointSpace space({&measured, &known});
  const std::vector<Station> stations{{geometry::look_at({14, 0, 8}, {0, 0, 8}), 1.0, 1, 0},
                                      {geometry::look_at({-14, 0, 8}, {0, 0, 8}), 1.0, 1, 1}};
  const Route route = plan_route(stations, {}, space, nullptr, options_with_returns());
  ASSERT_EQ(route.stations.size(), 2U);
  ASSERT_TRUE(route.returns);
  EXPECT_TRUE(check_route(sortie_points(route, route.sorties[0]), space, route.clearance).empty());
  const std::vector<Vector3d>& points = route.legs[0].points;
  ASSERT_GT(points.size(), 1U);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_TRUE(prove_returns(space, {points[i - 1], points[i]}, route.returns->law,
                              route.clearance - return_slack)
                    .is_proven);
  }
  // Up over 32 m and down again takes 28 + 48 m; nothing is shorter by much.
  EXPECT_LT(route.legs[0].length, 80.0);
  EXPECT_GT(route.legs[0].length, 28.0);
}

// The way with returns is half as long again. Whatever the battery, each view is flown or named:
// one that has become too far does not cost all of them.
TEST(WaysHome, AViewTooFarForTheBatteryIsLeftOutAndNamed) {
  MeasuredSpace measured = cellar();
  measured.declare_free(Eigen::AlignedBox3d(Vector3d(-20, -20, 0), Vector3d(-8, 20, 30)));
  Obstacles rules;
  rules.ground_height = 0.0;
  const KnownSpace known(rules);
  const JointSpace space({&measured, &known});
  const std::vector<Station> stations{{geometry::look_at({14, 0, 8}, {0, 0, 8}), 1.0, 1, 0},
                                      {geometry::look_at({-14, 0, 8}, {0, 0, 8}), 1.0, 1, 1}};
  int left_out = 0;
  for (double battery = 4.0; battery < 24.0; battery += 0.25) {
    Vehicle vehicle;
    vehicle.battery_wh = battery;
    vehicle.endurance_min = 0.3 * battery;
    RouteOptions options = options_with_returns();
    options.conditions.longest_flight = 1.5;
    const double usable = Motion(vehicle, options.conditions).usable_energy();
    const Route route = plan_route(stations, vehicle, space, nullptr, options);
    EXPECT_EQ(route.stations.size() + route.unreached.size(), 2U) << battery << " Wh";
    EXPECT_EQ(route.sorties.empty(), route.stations.empty()) << battery << " Wh";
    for (const Sortie& sortie : route.sorties) EXPECT_LE(1.5 * sortie.energy, usable);
    if (route.stations.size() != 1) continue;
    ++left_out;
    EXPECT_EQ(route.unreached[0].station.view_index, 1U);
    EXPECT_THAT(route.unreached[0].reason, HasSubstr("Wh above its reserve"));
  }
  EXPECT_GT(left_out, 2);
}

TEST(WaysHome, RefusesARouteWithoutASafeHeightOfReturn) {
  Obstacles obstacles = tower(30.0);
  obstacles.fence = Prism{"site", {{-90, -90}, {90, -90}, {90, 90}, {-90, 90}}, -1.0, 33.0};
  const KnownSpace space(obstacles);
  RouteOptions options;
  options.takeoff = {-60, 0, 0};
  options.returns = ReturnOptions{{Dialect::px4}, 31.0};
  const std::vector<Station> stations{{geometry::look_at({0, 0, 10}, {-30, 0, 10}), 1.0, 1, 3}};
  const Route route = plan_route(stations, {}, space, nullptr, options);
  EXPECT_TRUE(route.sorties.empty());
  ASSERT_EQ(route.unreached.size(), 1U);
  EXPECT_THAT(route.unreached[0].reason,
              AllOf(HasSubstr("no verified return"), HasSubstr("the level flight")));
}

// A way that is pulled tight ends where a rule begins: at the 50 m within which DJI's vehicles fly
// home level. The route's own proof divides its legs otherwise, and must not fail there.
TEST(WaysHome, LegsThatPassWhereARuleBeginsAreProvenInTheEndToo) {
  RouteOptions options;
  options.takeoff = {-60, 0, 0};
  options.returns = ReturnOptions{{Dialect::dji}, 36.0};
  options.order_is_free = true;
  const KnownSpace space(tower(30.0));
  std::mt19937 random(1);
  const auto within = [&](double low, double high) {
    return low + (high - low) * 0x1p-32 * static_cast<double>(random());
  };
  std::size_t reached = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Station> stations;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const double bearing = within(-0.5, 0.5), distance = within(50.0, 70.0);
      const Vector3d place(-60.0 + distance * std::cos(bearing), distance * std::sin(bearing),
                           within(5.0, i == 0 ? 45.0 : 30.0));
      stations.push_back({geometry::look_at(place, {-30, 0, place.z()}), 1.0, 1, i});
    }
    const Route route = plan_route(stations, {}, space, nullptr, options);
    ASSERT_TRUE(route.returns || route.stations.empty());
    reached += route.stations.size();
  }
  EXPECT_GT(reached, 80U);
}

// Climb and level flight by hand, in still air; hover for the waits and the descent.
TEST(ReturnEnergy, IsThatOfThePiecesAndTheWaits) {
  const Motion motion({}, {});
  ReturnLaw law = law_of({Dialect::px4});
  law.level = 30.0;
  const auto energy = [&](const Vector3d& way) {
    return motion.leg_energy(way, motion.leg_time(way));
  };
  const double pieces = energy({0, 0, 20}) + energy({-60, 0, 0});
  const double landing = motion.landing_time(30.0);
  const double total = return_energy(motion, law, {0, 0, 10});
  EXPECT_GT(total, pieces + motion.hover_energy(landing + 10.0));
  EXPECT_LT(total, pieces + motion.hover_energy(landing + 20.0));
}

}  // namespace
}  // namespace skycap::flight
