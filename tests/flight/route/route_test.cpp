#include "flight/route/route.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/prior_obstacle.h"
#include "flight/export/flight_plan.h"
#include "flight/paths/sampling_path.h"
#include "geometry/error.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using geometry::look_at;
using testing::HasSubstr;

/// Returns a building of 20 x 20 x 15 m on flat ground.
Obstacles site() {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({-10, -10, 0}, {10, 10, 15});
  obstacles.ground_height = 0.0;
  return obstacles;
}

/// Returns views on a ring around the building, ordered around it.
std::vector<CapturePoint> ring(int count, double distance, double height) {
  std::vector<CapturePoint> capture_points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const Vector3d position(distance * std::cos(angle), distance * std::sin(angle), height);
    capture_points.push_back(
        {look_at(position, {0, 0, height}), 2.0, 1, static_cast<std::uint32_t>(i)});
  }
  return capture_points;
}

RouteOptions options() {
  RouteOptions result;
  result.takeoff = {-30, -30, 0};
  return result;
}

Route plan(const std::vector<CapturePoint>& capture_points, const Obstacles& obstacles,
           const RouteOptions& how = options(), const Vehicle& vehicle = {}) {
  const KnownSpace space(obstacles);
  const KnownSpace pad_space(without_ground(obstacles));
  return plan_route(capture_points, vehicle, space, &pad_space, how);
}

TEST(Route, VisitsAllCapturePointsOnVerifiedLegs) {
  const Obstacles obstacles = site();
  const Route route = plan(ring(12, 16, 8), obstacles);
  EXPECT_EQ(route.capture_points.size(), 12U);
  EXPECT_TRUE(route.unreached.empty());
  ASSERT_EQ(route.sorties.size(), 1U);
  EXPECT_DOUBLE_EQ(route.clearance, 2.0);
  EXPECT_GE(route.min_clearance, 2.0);
  const KnownSpace space(obstacles);
  EXPECT_THAT(check_route(sortie_points(route, route.sorties[0]), space, 2.0), testing::IsEmpty());
  EXPECT_LE(route.straight_length, route.capture_leg_length + 1e-9);
  EXPECT_LE(route.capture_leg_length, 1.25 * route.straight_length);
  EXPECT_GE(route.length, route.capture_leg_length);
}

Obstacles open_ground() {
  Obstacles obstacles;
  obstacles.ground_height = 0.0;
  return obstacles;
}

/// Open terrain in which the path search finds all paths, but no leg through a gate can be
/// verified. The gate is the half plane x = 0, y > 0.
class UnprovableGate : public KnownSpace {
 public:
  UnprovableGate() : KnownSpace(open_ground()) {}

  Closest closest(const Segment& leg, double up_to) const override {
    Closest closest = KnownSpace::closest(leg, up_to);
    if (crosses(leg)) closest.distance = std::min(closest.distance, 1.5);
    return closest;
  }

  static bool crosses(const Segment& leg) {
    const double from = leg.from.x(), to = leg.to.x();
    if (from * to >= 0.0) return false;
    const double share = from / (from - to);
    return leg.from.y() + share * (leg.to.y() - leg.from.y()) > 0.0;
  }
};

TEST(Route, OmitsCapturePointsWithoutVerifiedPath) {
  const UnprovableGate space;
  // From the pad at (-30, -30), the paths to the first two views pass below the gate and the path
  // to the third leads through it. The straight line from the first to the second also leads
  // through it.
  const std::vector<CapturePoint> capture_points{{look_at({-20, 10, 20}, {0, 0, 20}), 2.0, 1, 0},
                                                 {look_at({20, 10, 20}, {0, 0, 20}), 2.0, 1, 1},
                                                 {look_at({5, 60, 20}, {0, 0, 20}), 2.0, 1, 2}};
  RouteOptions how = options();
  how.order_is_free = false;
  const Route route = plan_route(capture_points, {}, space, nullptr, how);
  ASSERT_EQ(route.capture_points.size(), 2U);
  ASSERT_EQ(route.unreached.size(), 1U);
  EXPECT_EQ(route.unreached[0].capture_point.view_index, 2U);
  EXPECT_EQ(
      route.unreached[0].reason,
      "the path to it cannot be verified with a clearance of 2.000 m; lower flight.clearance");
  for (const Sortie& sortie : route.sorties) {
    EXPECT_THAT(check_route(sortie_points(route, sortie), space, 2.0), testing::IsEmpty());
  }
}

// Straight legs between corner views would cross the building, although the views themselves keep
// the clearance.
TEST(Route, RoutesLegsAroundObstacles) {
  std::vector<CapturePoint> capture_points{{look_at({0, -14, 8}, {0, 0, 8})},
                                           {look_at({0, 14, 8}, {0, 0, 8})}};
  const Route route = plan(capture_points, site());
  ASSERT_EQ(route.legs.size(), 1U);
  EXPECT_GT(route.legs[0].points.size(), 2U);
  EXPECT_GE(route.legs[0].clearance, 2.0);
}

// The grid is too coarse for the window, so the sampling planner must find it.
TEST(Route, FindsNarrowPassagesBySampling) {
  const Obstacles obstacles = scenes::wall_with_window();
  RouteOptions how = options();
  how.takeoff = {-8, -6, 15};
  how.path.finest_cell = 9.0;
  const Vector3d home(-8, -6, 20), behind(-8, 7, 20);
  const KnownSpace space(obstacles);
  const double clearance = how.clearance.total();
  ASSERT_EQ(PathFinder(space, clearance, how.path).find(home, behind).status,
            PathStatus::unreachable);

  const Route route = plan_route({{look_at(behind, {-8, 20, 20})}}, {}, space, nullptr, how);
  ASSERT_EQ(route.capture_points.size(), 1U);
  EXPECT_THAT(check_route(sortie_points(route, route.sorties[0]), space, clearance),
              testing::IsEmpty());
}

/// Returns capture points in front of the wall and behind it, with the survey's approach path
/// through the window.
std::vector<CapturePoint> window_stations() {
  const Vector3d home(-8, -6, 20), before(-8, -7, 22), in_window(0, 0, 20), behind(-8, 7, 20);
  std::vector<CapturePoint> capture_points{{look_at(before, {-8, -20, 22})},
                                           {look_at(behind, {-8, 20, 20})}};
  capture_points[0].approach_path = {home, before};
  capture_points[1].approach_path = {before, in_window + Vector3d(0, -6, 0),
                                     in_window + Vector3d(0, 6, 0), behind};
  capture_points[1].view_index = 1;
  return capture_points;
}

// In the order of the survey, legs are those of the survey. In another order, they are the shortest
// paths found.
TEST(Route, KeepsSurveyPathsInSurveyOrder) {
  const KnownSpace space(scenes::wall_with_window());
  RouteOptions how = options();
  how.takeoff = {-8, -6, 15};
  const std::vector<CapturePoint> capture_points = window_stations();
  const Route route = plan_route(capture_points, {}, space, nullptr, how);
  ASSERT_EQ(route.capture_points.size(), 2U);
  EXPECT_EQ(route.sorties[0].out.points, capture_points[0].approach_path);
  EXPECT_EQ(route.legs[0].points, capture_points[1].approach_path);
  how.order_is_free = true;
  const Route shortest = plan_route(capture_points, {}, space, nullptr, how);
  ASSERT_EQ(shortest.legs.size(), 1U);
  EXPECT_LT(shortest.legs[0].length, route.legs[0].length);
}

TEST(Route, FindsOtherPathWhenApproachPathIsBlocked) {
  const KnownSpace space(scenes::wall_with_window());
  RouteOptions how = options();
  how.takeoff = {-8, -6, 15};
  std::vector<CapturePoint> capture_points = window_stations();
  capture_points.erase(capture_points.begin());
  capture_points[0].approach_path = {{-8, -6, 20},
                                     capture_points[0].view.position};  // through the wall
  const Route route = plan_route(capture_points, {}, space, nullptr, how);
  ASSERT_EQ(route.capture_points.size(), 1U);
  EXPECT_GT(route.sorties[0].out.points.size(), 2U);
}

// A tree above a rally point, too low for the level return and too high for a landing.
TEST(Route, RejectsRallyPointWithObstacleAbove) {
  Obstacles obstacles = site();
  RouteOptions how = options();
  how.returns = ReturnOptions{{AutopilotType::px4}, 60.0, {Vector3d(30, 30, 0)}};
  EXPECT_NO_THROW(plan(ring(3, 16, 8), obstacles, how));
  PriorObstacleConfig tree;
  tree.name = "the tree";
  tree.points = {{30.0F, 30.0F, 3.0F}};
  tree.point_radius = 0.5;
  obstacles.priors.push_back(std::make_shared<const PriorObstacle>(tree));
  EXPECT_THAT([&] { plan(ring(3, 16, 8), obstacles, how); },
              testing::ThrowsMessage<Error>(HasSubstr("the climb from the rally point")));
}

// A window with 5 mm more than the clearance: neither planner finds a path, but the survey did.
TEST(Route, UsesSurveyPathWhenPathFindersFail) {
  Obstacles obstacles = scenes::wall_with_window();
  for (const double side : {-1.0, 1.0}) {
    const double edge = 2.005 * side, far = 4.0 * side;
    geometry::append(obstacles.mesh,
                     scenes::box({std::min(edge, far), 0, 16}, {std::max(edge, far), 1, 24}));
  }
  const KnownSpace space(obstacles);
  RouteOptions how = options();
  how.takeoff = {-8, -6, 15};
  how.path.finest_cell = 9.0;
  how.order_is_free = true;
  const std::vector<CapturePoint> capture_points = window_stations();
  const Vector3d home(-8, -6, 20), behind = capture_points[1].view.position;
  const double clearance = how.clearance.total();
  ASSERT_EQ(PathFinder(space, clearance, how.path).find(home, behind).status,
            PathStatus::unreachable);
  ASSERT_EQ(find_path_by_sampling(space, home, behind, clearance).status, PathStatus::unreachable);

  const Route route = plan_route(capture_points, {}, space, nullptr, how);
  EXPECT_EQ(route.capture_points.size(), 2U);
  EXPECT_THAT(check_route(sortie_points(route, route.sorties.at(0)), space, clearance),
              testing::IsEmpty());
}

// The survey's path is not verified by having been flown; it is verified again.
TEST(Route, ReplacesSurveyPathThatIsNotFree) {
  const KnownSpace space(scenes::wall_with_window());
  RouteOptions how = options();
  how.takeoff = {-8, -6, 15};
  std::vector<CapturePoint> capture_points = window_stations();
  capture_points[1].approach_path = {capture_points[1].approach_path.front(),
                                     capture_points[1].approach_path.back()};  // through the wall
  const Route route = plan_route(capture_points, {}, space, nullptr, how);
  for (const Sortie& sortie : route.sorties) {
    EXPECT_THAT(check_route(sortie_points(route, sortie), space, route.clearance),
                testing::IsEmpty());
  }
  ASSERT_EQ(route.legs.size(), 1U);
  EXPECT_GT(route.legs[0].points.size(), 2U);
}

// Sorties are split for stop-and-capture. A curve must fit into the energy reserved for its leg.
TEST(Route, UsesLessTimeAndEnergyForCurvesThanForStops) {
  const std::vector<CapturePoint> capture_points{{look_at({0, -14, 8}, {0, 0, 8})},
                                                 {look_at({0, 14, 8}, {0, 0, 8})}};
  const Route stops = plan(capture_points, site());
  for (const FlightStyle style : {FlightStyle::blend, FlightStyle::smooth}) {
    RouteOptions how = options();
    how.style = style;
    const Route route = plan(capture_points, site(), how);
    ASSERT_TRUE(route.legs[0].smooth);
    EXPECT_EQ(route.legs[0].points, stops.legs[0].points);
    EXPECT_EQ(route.duration, stops.duration);
    EXPECT_LT(route.legs[0].smooth->duration, route.legs[0].duration);
    EXPECT_LT(route.legs[0].smooth->energy, route.legs[0].energy);
    EXPECT_GE(route.legs[0].smooth->clearance, 2.0);
  }
}

// The durations of sorties equal those in the exported files, including stops at corners.
TEST(Route, HasSortieDurationsOfFlightPlans) {
  const Route route = plan(ring(8, 16, 8), site());
  ASSERT_EQ(route.sorties.size(), 1U);
  const FlightPlan exported = flight_plan(route, 0, "ring", {{51.75, -1.25, 100.0}, {}}, site());
  EXPECT_NEAR(route.sorties[0].duration, flight_time(exported), 1e-6);
}

TEST(Route, ReportsUnreachableViewsAndVisitsTheRest) {
  std::vector<CapturePoint> capture_points = ring(6, 16, 8);
  capture_points.insert(capture_points.begin() + 2,
                        {look_at({0, 0, 5}, {1, 0, 5}), 2, 1, 77});  // inside the building
  capture_points.insert(capture_points.begin() + 4,
                        {look_at({11, 0, 5}, {0, 0, 5}), 2, 1, 78});       // too close
  capture_points.push_back({look_at({20, 0, 5}, {20, 0, 50}), 2, 1, 79});  // looks straight up
  const Route route = plan(capture_points, site());
  EXPECT_EQ(route.capture_points.size(), 6U);
  ASSERT_EQ(route.unreached.size(), 3U);
  EXPECT_EQ(route.unreached[0].capture_point.view_index, 77U);
  EXPECT_THAT(route.unreached[1].reason, HasSubstr("it is 1.0"));
  EXPECT_THAT(route.unreached[2].reason, HasSubstr("gimbal"));
}

// Requirement: with a small battery, no sorties below the reserve, and at most 15% above the
// printed bound.
TEST(Route, SplitsIntoSortiesThatKeepReserve) {
  Vehicle small;
  small.battery_wh = 12.0, small.endurance_min = 3.6;
  const Route route = plan(ring(60, 18, 8), site(), options(), small);
  EXPECT_EQ(route.capture_points.size(), 60U);
  EXPECT_GT(route.sorties.size(), 2U);
  std::uint32_t next = 0;
  double duration = 0.0;
  for (const Sortie& sortie : route.sorties) {
    EXPECT_EQ(sortie.first, next);
    next = sortie.last + 1;
    EXPECT_GE(sortie.energy_left, 0.0);
    duration += sortie.duration;
  }
  EXPECT_EQ(next, 60U);
  EXPECT_NEAR(duration, route.duration, 1e-6);
  EXPECT_LE(route.duration, 1.15 * route.duration_bound);
}

TEST(Route, SplitsAtWaypointLimit) {
  Vehicle old;
  old.max_waypoints = 94;  // room for ten capture points
  const Route route = plan(ring(24, 18, 8), site(), options(), old);
  EXPECT_EQ(route.sorties.size(), 3U);
}

TEST(Route, LimitsWaypointsPerSortieOfConsumerDrones) {
  Vehicle consumer = vehicle_profile("m350_rtk");
  consumer.app = MissionApp::litchi;
  for (const int limit : {20, 21, 34, 99}) {
    consumer.max_waypoints = limit;
    const Route route = plan(ring(60, 18, 8), site(), options(), consumer);
    ASSERT_TRUE(route.unreached.empty());
    std::uint32_t next = 0;
    std::size_t most = 0;
    for (const Sortie& sortie : route.sorties) {
      EXPECT_EQ(sortie.first, next);
      next = sortie.last + 1;
      const std::size_t waypoints = sortie_points(route, sortie).size();
      EXPECT_LE(waypoints, static_cast<std::size_t>(limit));
      most = std::max(most, waypoints);
    }
    EXPECT_EQ(next, 60U);
    // 60 captures, and at least the two waypoints above the pad per sortie.
    EXPECT_GE(route.sorties.size(),
              (60U + static_cast<std::size_t>(limit) - 3) / static_cast<std::size_t>(limit - 2));
    EXPECT_GE(most + 6, std::min<std::size_t>(60, static_cast<std::size_t>(limit)));
  }
}

TEST(Route, FillsASortieToTheWaypointLimitAndDividesItAboveTheLimit) {
  Vehicle consumer = vehicle_profile("m350_rtk");
  consumer.app = MissionApp::litchi;
  const Route whole = plan(ring(20, 18, 8), site(), options(), consumer);
  ASSERT_EQ(whole.sorties.size(), 1U);
  const auto waypoints = static_cast<int>(sortie_points(whole, whole.sorties[0]).size());
  consumer.max_waypoints = waypoints;
  EXPECT_EQ(plan(ring(20, 18, 8), site(), options(), consumer).sorties.size(), 1U);
  consumer.max_waypoints = waypoints - 1;
  EXPECT_EQ(plan(ring(20, 18, 8), site(), options(), consumer).sorties.size(), 2U);
}

TEST(Route, ReportsCapturePointOutOfBatteryRange) {
  std::vector<CapturePoint> capture_points = ring(3, 18, 8);
  capture_points.push_back({look_at({40000, 0, 50}, {0, 0, 8}), 1, 1, 9});
  const Route route = plan(capture_points, site());
  ASSERT_EQ(route.unreached.size(), 1U);
  EXPECT_THAT(route.unreached[0].reason, HasSubstr("Wh above its reserve"));
}

TEST(Route, ShortensRouteWithFreeOrderAndKeepsBound) {
  std::vector<CapturePoint> shuffled;
  for (const CapturePoint& capture_point : ring(20, 18, 8)) {
    shuffled.insert(
        shuffled.begin() + static_cast<std::ptrdiff_t>(7 * shuffled.size() % (shuffled.size() + 1)),
        capture_point);
  }
  RouteOptions free_order = options();
  free_order.order_is_free = true;
  const Route input_order = plan(shuffled, site()), ordered = plan(shuffled, site(), free_order);
  EXPECT_LT(ordered.length, input_order.length);
  EXPECT_LE(ordered.order_bound, ordered.order_length + 1e-9);
  EXPECT_LE(ordered.order_length, 1.1 * ordered.order_bound);
}

TEST(Route, RejectsBlockedTakeOffPoint) {
  RouteOptions inside = options();
  inside.takeoff = {0, 0, 0};
  EXPECT_THAT(testing_support::thrown_message([&] { plan(ring(3, 18, 8), site(), inside); }),
              testing::HasSubstr("is 0.000 m from"));
  Obstacles with_roof = site();
  geometry::append(with_roof.mesh, scenes::box({-33, -33, 2}, {-31.5, -27, 2.5}));
  try {
    plan(ring(3, 18, 8), with_roof);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the climb from the take-off point"));
  }
}

// The climb above the pad is verified like a leg, in all known space.
TEST(Route, RejectsTakeOffClimbNearMeasuredTree) {
  const auto plan_at_distance = [](double distance) {
    Obstacles with_tree = site();
    const double west = -30.0 - distance;
    geometry::append(with_tree.mesh, scenes::box({west - 0.3, -30.2, 0}, {west, -29.8, 3}));
    const KnownSpace space(with_tree);
    return plan_route(ring(3, 18, 8), {}, space, nullptr, options());
  };
  EXPECT_NO_THROW(plan_at_distance(2.5));
  try {
    plan_at_distance(1.5);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("the climb from the take-off point comes within 1.500 m of triangle"));
  }
}

TEST(Route, RejectsInvalidOptions) {
  RouteOptions negative = options();
  negative.clearance.margin = -1;
  EXPECT_THAT(testing_support::thrown_message([&] { plan({}, site(), negative); }),
              testing::HasSubstr("clearance.margin is -1"));
  RouteOptions nowhere = options();
  nowhere.takeoff.x() = std::nan("");
  EXPECT_THAT(testing_support::thrown_message([&] { plan({}, site(), nowhere); }),
              testing::HasSubstr("the take-off point has a non-finite position"));
  EXPECT_TRUE(plan({}, site()).sorties.empty());  // an empty plan is valid
}

TEST(CheckRoute, ReportsLegPositionAndDistance) {
  const KnownSpace space(site());
  const std::vector<Violation> violations =
      check_route({{-20, -20, 8}, {20, -20, 8}, {20, 20, 8}, {-20, -20, 8}}, space, 2.0);
  ASSERT_EQ(violations.size(), 1U);
  EXPECT_EQ(violations[0].leg, 2U);
  EXPECT_THAT(describe(violations[0]), HasSubstr("leg 2: 0.000 m from triangle"));
  EXPECT_EQ(check_route({{0, 0, 5}}, space, 1.0).size(), 1U);
  EXPECT_TRUE(check_route({}, space, 1.0).empty());
  EXPECT_THAT(testing_support::thrown_message([&] {
                check_route({{0, 0, std::nan("")}}, space, 1.0);
              }),
              testing::HasSubstr("point 0 of the route has a non-finite position"));
}

TEST(CapturePoint, HasYawClockwiseFromNorthAndPitchFromHorizon) {
  const Vector3d eye = Vector3d::Zero();
  EXPECT_DOUBLE_EQ(compute_yaw(look_at(eye, {0, 5, 0})), 0.0);
  EXPECT_DOUBLE_EQ(compute_yaw(look_at(eye, {5, 0, 0})), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(compute_yaw(look_at(eye, {-5, 0, 0})), 1.5 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(compute_pitch(look_at(eye, {0, 1, -1})), -std::numbers::pi / 4);
  EXPECT_DOUBLE_EQ(compute_yaw(look_at(eye, {0, 0, -1})), 0.0);
}

}  // namespace
}  // namespace skycap::flight
