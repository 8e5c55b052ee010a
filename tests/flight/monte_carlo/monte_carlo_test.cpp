#include "flight/monte_carlo/monte_carlo.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/mission_interpreter.h"
#include "geometry/random_numbers.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/flight/interpreter/spoiled.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

// Property: the minimum distance of all steps is bitwise equal to that of separate queries.
TEST(NearestPass, FindsMinDistanceOfAllSteps) {
  std::mt19937_64 random(4);
  Obstacles obstacles;
  obstacles.mesh = scenes::boxes(random, 12);
  const KnownSpace space(obstacles);
  geometry::RandomNumbers draws(4, 2);
  for (int path = 0; path < 50; ++path) {
    NearestPass pass(space, 8.0);
    double min = 8.0;
    Vector3d position{draws.between(-30, 30), draws.between(-30, 30), draws.between(0, 30)};
    Vector3d velocity = Vector3d::Zero();
    for (int i = 0; i < 500; ++i) {
      velocity += 0.02 * Vector3d{draws.normal(), draws.normal(), draws.normal()};
      const Segment step{position, position + velocity};
      pass.pass(step);
      min = std::min(min, space.closest(step, 8.0).distance);
      position = step.to;
    }
    EXPECT_EQ(pass.nearest().distance, min);
  }
}

class SampleFlight : public testing::TestWithParam<AutopilotType> {
 protected:
  const Obstacles site_ = sample_site();
  const KnownSpace space_{site_}, pad_space_{without_ground(site_)};
  const FlightPlan plan_ = sample_plan(
      vehicle_profile(GetParam() == AutopilotType::px4 ? "generic" : "generic_ardupilot"));
  const std::vector<ClearanceCriterion> criteria_{{"the site", space_, pad_space_, 1.55, 1.9}};

  SimulatedMission mission() const {
    const Motion motion(plan_.vehicle, plan_.conditions);
    RtlProfile rtl_profile = plan_.verified_returns().rtl_profile;
    rtl_profile.autopilots = {GetParam()};
    return {
        make_flight_script(interpret(sample_file(GetParam()), make_flight_facts(plan_)), motion),
        motion, rtl_profile};
  }
};

INSTANTIATE_TEST_SUITE_P(FlyTest, SampleFlight,
                         testing::Values(AutopilotType::px4, AutopilotType::ardupilot));

TEST_P(SampleFlight, KeepsClearanceInLightWind) {
  const FlyTest test =
      fly_test(mission(), criteria_, {.flights = 12, .returns = 500, .wind_speed = 3});
  ASSERT_EQ(test.flights.size(), 12U);
  EXPECT_EQ(flights_nearer(test, criteria_, 0), 0U);
  EXPECT_GT(test.returns[0].simulated, 500U);
  EXPECT_EQ(test.returns[0].nearer, 0U);
  for (const TestFlight& flight : test.flights) {
    if (flight.draw.return_time) continue;
    EXPECT_NEAR(flight.simulated.time, test.planned_time, 0.05 * test.planned_time);
    EXPECT_LT(flight.simulated.off_line, 0.6);
  }
}

TEST_P(SampleFlight, DoesNotDependOnThreadCount) {
  const FlyTest one = fly_test(mission(), criteria_, {.flights = 6, .returns = 50, .threads = 1});
  const FlyTest four = fly_test(mission(), criteria_, {.flights = 6, .returns = 50, .threads = 4});
  ASSERT_FALSE(one.flights.empty());
  for (std::size_t i = 0; i < one.flights.size(); ++i) {
    EXPECT_EQ(one.flights[i].simulated.time, four.flights[i].simulated.time);
    EXPECT_EQ(one.flights[i].simulated.energy, four.flights[i].simulated.energy);
    EXPECT_EQ(one.flights[i].simulated.nearest[0].closest.distance,
              four.flights[i].simulated.nearest[0].closest.distance);
  }
  EXPECT_EQ(one.returns[0].nearest.distance, four.returns[0].nearest.distance);
}

TEST_P(SampleFlight, CollidesWithUnknownTree) {
  Obstacles site = site_;
  const SimulatedMission simulated = mission();
  const ScriptedLeg& leg = simulated.script[simulated.script.size() / 2];
  const Vector3d tree = 0.5 * (leg.from + leg.to);
  site.no_fly.push_back(
      {"tree",
       {tree.head<2>() - Eigen::Vector2d(0.3, 0.3), tree.head<2>() + Eigen::Vector2d(0.3, -0.3),
        tree.head<2>() + Eigen::Vector2d(0.3, 0.3), tree.head<2>() + Eigen::Vector2d(-0.3, 0.3)}});
  const KnownSpace space(site), pad_space(without_ground(site));
  const std::vector<ClearanceCriterion> criteria{{"the site", space, pad_space, 1.55, 1.9}};
  const FlyTest test = fly_test(simulated, criteria, {.flights = 2});
  EXPECT_EQ(test.flights[0].simulated.nearest[0].closest.kind, ObstacleKind::no_fly);
  EXPECT_LT(test.flights[0].simulated.nearest[0].closest.distance, 0.5);
}

// Worst case: a return altitude at half the height of the building.
TEST_P(SampleFlight, DetectsReturnsThatAreTooLow) {
  SimulatedMission simulated = mission();
  simulated.rtl_profile->level = 8.0;
  const FlyTest test =
      fly_test(simulated, criteria_, {.flights = 40, .returns = 500, .wind_speed = 0});
  EXPECT_GT(test.returns[0].nearer, 50U);
  EXPECT_LT(test.returns[0].nearest.distance, 0.1);
  EXPECT_GT(flights_nearer(test, criteria_, 0), 2U);
  for (const TestFlight& flight : test.flights) {
    const NearestApproach& nearest = flight.simulated.nearest[0];
    EXPECT_TRUE(nearest.closest.distance > 1.5 || nearest.is_returning);
  }
}

TEST_P(SampleFlight, EndsWhenStopIsRequested) {
  std::stop_source stop;
  FlyTestOptions options{.flights = 1000, .threads = 1, .stop = stop.get_token()};
  options.report = [&](std::size_t simulated) {
    if (simulated == 3) stop.request_stop();
  };
  const FlyTest test = fly_test(mission(), criteria_, options);
  EXPECT_EQ(test.flights.size(), 3U);
  EXPECT_FALSE(test.is_complete);
}

}  // namespace
}  // namespace skycap::flight
