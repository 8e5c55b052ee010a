#include "flight/fly_test/fly_test.h"

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

// Property: the least distance of all steps, to the last bit, as if each had been asked for.
TEST(NearestPass, FindsTheNearestOfAllSteps) {
  std::mt19937_64 random(4);
  Obstacles obstacles;
  obstacles.mesh = scenes::boxes(random, 12);
  const KnownSpace space(obstacles);
  geometry::RandomNumbers draws(4, 2);
  for (int path = 0; path < 50; ++path) {
    NearestPass pass(space, 8.0);
    double least = 8.0;
    Vector3d place{draws.between(-30, 30), draws.between(-30, 30), draws.between(0, 30)};
    Vector3d velocity = Vector3d::Zero();
    for (int i = 0; i < 500; ++i) {
      velocity += 0.02 * Vector3d{draws.normal(), draws.normal(), draws.normal()};
      const Segment step{place, place + velocity};
      pass.pass(step);
      least = std::min(least, space.closest(step, 8.0).distance);
      place = step.to;
    }
    EXPECT_EQ(pass.nearest().distance, least);
  }
}

class FlownSample : public testing::TestWithParam<Dialect> {
 protected:
  const Obstacles site_ = sample_site();
  const KnownSpace space_{site_}, pad_space_{without_ground(site_)};
  const FlightPlan plan_ =
      sample_plan(vehicle_profile(GetParam() == Dialect::px4 ? "generic" : "generic_ardupilot"));
  const std::vector<Judge> judges_{{"the site", space_, pad_space_, 1.55, 1.9}};

  FlownMission mission() const {
    const Motion motion(plan_.vehicle, plan_.conditions);
    ReturnLaw law = plan_.certified_returns().law;
    law.dialects = {GetParam()};
    return {script_of(interpret(sample_file(GetParam()), facts_of(plan_)), motion), motion, law};
  }
};

INSTANTIATE_TEST_SUITE_P(FlyTest, FlownSample, testing::Values(Dialect::px4, Dialect::ardupilot));

TEST_P(FlownSample, KeepsItsClearanceInALightWind) {
  const FlyTest test =
      fly_test(mission(), judges_, {.flights = 12, .returns = 500, .wind_speed = 3});
  ASSERT_EQ(test.flights.size(), 12U);
  EXPECT_EQ(flights_nearer(test, judges_, 0), 0U);
  EXPECT_GT(test.returns[0].flown, 500U);
  EXPECT_EQ(test.returns[0].nearer, 0U);
  for (const TestFlight& flight : test.flights) {
    if (flight.draw.called_home) continue;
    EXPECT_NEAR(flight.flown.time, test.planned_time, 0.05 * test.planned_time);
    EXPECT_LT(flight.flown.off_line, 0.6);
  }
}

TEST_P(FlownSample, IsTheSameForAnyNumberOfThreads) {
  const FlyTest one = fly_test(mission(), judges_, {.flights = 6, .returns = 50, .threads = 1});
  const FlyTest four = fly_test(mission(), judges_, {.flights = 6, .returns = 50, .threads = 4});
  ASSERT_FALSE(one.flights.empty());
  for (std::size_t i = 0; i < one.flights.size(); ++i) {
    EXPECT_EQ(one.flights[i].flown.time, four.flights[i].flown.time);
    EXPECT_EQ(one.flights[i].flown.energy, four.flights[i].flown.energy);
    EXPECT_EQ(one.flights[i].flown.nearest[0].closest.distance,
              four.flights[i].flown.nearest[0].closest.distance);
  }
  EXPECT_EQ(one.returns[0].nearest.distance, four.returns[0].nearest.distance);
}

TEST_P(FlownSample, CollidesWithATreeThatNobodyKnewOf) {
  Obstacles site = site_;
  const FlownMission flown = mission();
  const ScriptedLeg& leg = flown.script[flown.script.size() / 2];
  const Vector3d tree = 0.5 * (leg.from + leg.to);
  site.no_fly.push_back(
      {"tree",
       {tree.head<2>() - Eigen::Vector2d(0.3, 0.3), tree.head<2>() + Eigen::Vector2d(0.3, -0.3),
        tree.head<2>() + Eigen::Vector2d(0.3, 0.3), tree.head<2>() + Eigen::Vector2d(-0.3, 0.3)}});
  const KnownSpace space(site), pad_space(without_ground(site));
  const std::vector<Judge> judges{{"the site", space, pad_space, 1.55, 1.9}};
  const FlyTest test = fly_test(flown, judges, {.flights = 2});
  EXPECT_EQ(test.flights[0].flown.nearest[0].closest.kind, ObstacleKind::no_fly);
  EXPECT_LT(test.flights[0].flown.nearest[0].closest.distance, 0.5);
}

// The review's worst: a height of return in the middle of the building.
TEST_P(FlownSample, ReturnsThatAreTooLowAreFound) {
  FlownMission flown = mission();
  flown.law->level = 8.0;
  const FlyTest test = fly_test(flown, judges_, {.flights = 40, .returns = 500, .wind_speed = 0});
  EXPECT_GT(test.returns[0].nearer, 50U);
  EXPECT_LT(test.returns[0].nearest.distance, 0.1);
  EXPECT_GT(flights_nearer(test, judges_, 0), 2U);
  for (const TestFlight& flight : test.flights) {
    const NearestPlace& nearest = flight.flown.nearest[0];
    EXPECT_TRUE(nearest.closest.distance > 1.5 || nearest.is_on_way_home);
  }
}

TEST_P(FlownSample, EndsWhenItIsStopped) {
  std::stop_source stop;
  FlyTestOptions options{.flights = 1000, .threads = 1, .stop = stop.get_token()};
  options.report = [&](std::size_t flown) {
    if (flown == 3) stop.request_stop();
  };
  const FlyTest test = fly_test(mission(), judges_, options);
  EXPECT_EQ(test.flights.size(), 3U);
  EXPECT_FALSE(test.is_complete);
}

}  // namespace
}  // namespace skycap::flight
