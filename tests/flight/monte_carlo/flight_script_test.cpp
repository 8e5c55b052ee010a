#include "flight/monte_carlo/flight_script.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "flight/export/wpml_file.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/mission_interpreter.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "tests/flight/export/sample_plan.h"
#include "tests/flight/interpreter/spoiled.h"
#include "tests/flight/vehicles.h"
#include "tests/support/not_empty.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// The sample flight, read from the mission file for this vehicle.
struct Sample {
  explicit Sample(const std::string& vehicle) : plan(sample_plan(vehicle_profile(vehicle))) {
    const FlightFacts facts = make_flight_facts(plan);
    const InterpretedRoute route = plan.vehicle.autopilot == AutopilotType::dji
                                       ? interpret(unpack_kmz(write_kmz(plan)), facts)
                                       : interpret(sample_file(plan.vehicle.autopilot), facts);
    script = make_flight_script(route, motion());
  }
  Motion motion() const { return {plan.vehicle, plan.conditions}; }
  double jerk() const { return plan.vehicle.mode.jerk; }

  FlightPlan plan;
  FlightScript script;
};

class ExportedScript : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(FlightScript, ExportedScript,
                         testing::Values("generic", "generic_ardupilot", "m350_rtk"),
                         [](const auto& parameter) { return std::string(parameter.param); });

TEST_P(ExportedScript, VisitsAllWaypointsAndReturnsToPad) {
  const Sample sample(GetParam());
  EXPECT_LT((sample.script.front().from - sample.plan.pad).norm(), rounding_bound);
  EXPECT_LT((sample.script.back().to - sample.plan.pad).norm(), 2.0 * rounding_bound);
  ASSERT_GT(sample.script.size(), 1U);
  for (std::size_t i = 1; i < sample.script.size(); ++i) {
    EXPECT_EQ(sample.script[i].from, sample.script[i - 1].to) << i;
  }
  for (const Waypoint& waypoint : testing_support::not_empty(sample.plan.waypoints)) {
    double nearest = 1e9, wait = 0.0;
    for (const ScriptedLeg& leg : sample.script) {
      if ((leg.to - waypoint.position).norm() >= nearest) continue;
      nearest = (leg.to - waypoint.position).norm();
      wait = leg.wait;
    }
    EXPECT_LT(nearest, 2.0 * rounding_bound);
    if (!waypoint.is_capture_point) continue;
    EXPECT_GE(wait, waypoint.hold + waypoint.hold_after - 0.01);
  }
}

// The plan's flight time is computed from the route, the script's from the file.
TEST_P(ExportedScript, MatchesFlightTimeOfPlan) {
  const Sample sample(GetParam());
  EXPECT_NEAR(duration(sample.script) / flight_time(sample.plan), 1.0, 0.02);
}

TEST_P(ExportedScript, KeepsSpeedAndAccelerationLimits) {
  const Sample sample(GetParam());
  for (const ScriptedLeg& leg : testing_support::not_empty(sample.script)) {
    EXPECT_LT((set_point(leg, sample.jerk(), 0.0).position - leg.from).norm(), 1e-9);
    EXPECT_LT((set_point(leg, sample.jerk(), leg.duration()).position - leg.to).norm(), 1e-9);
    for (double t = 0.0; t < leg.moving; t += 0.05) {
      const SetPoint point = set_point(leg, sample.jerk(), t);
      EXPECT_LT(point.velocity.norm(), leg.speed + 1e-9);
      EXPECT_LT(point.acceleration.norm(), leg.acceleration + 1e-9);
    }
  }
}

// Property: if a leg is aborted anywhere, the vehicle stops on that leg.
TEST_P(ExportedScript, BrakesToRestOnItsLeg) {
  const Sample sample(GetParam());
  for (const ScriptedLeg& leg : testing_support::not_empty(sample.script)) {
    const Vector3d displacement = leg.to - leg.from;
    for (double t = 0.0; t < leg.duration(); t += 0.21) {
      const double braking = braking_time(leg, sample.jerk(), t);
      const SetPoint rest = braking_point(leg, sample.jerk(), t, braking);
      EXPECT_LT(rest.velocity.norm(), 1e-9);
      const double along =
          (rest.position - leg.from).dot(displacement) / std::max(1e-9, displacement.norm());
      EXPECT_LT(along, displacement.norm() + 1e-9);
      EXPECT_GT(along, -1e-9);
      const SetPoint begin = braking_point(leg, sample.jerk(), t, 0.0);
      EXPECT_LT((begin.position - set_point(leg, sample.jerk(), t).position).norm(), 1e-9);
    }
  }
}

// A file with half the speed takes longer, according to the motion law of its legs.
TEST(FlightScript, UsesSpeedOfFile) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  MavlinkMission file = sample_file(AutopilotType::px4);
  file.items[find_index(file, command::change_speed)].params[1] =
      0.5 * plan.conditions.cruise_speed;
  const Motion motion(plan.vehicle, plan.conditions);
  Conditions slow = plan.conditions;
  slow.cruise_speed *= 0.5;
  const FlightScript script = make_flight_script(interpret(file, make_flight_facts(plan)), motion);
  std::size_t legs = 0;
  for (const ScriptedLeg& leg : script) {
    if (leg.is_over_pad || leg.to.z() == plan.pad.z()) continue;
    const Vector3d displacement = leg.to - leg.from;
    if (displacement.norm() == 0.0 || displacement.head<2>().norm() < 0.1) continue;
    EXPECT_NEAR(leg.moving + plan.vehicle.mode.settle_time,
                Motion(plan.vehicle, slow).leg_time(displacement), 1e-9);
    ++legs;
  }
  EXPECT_GE(legs, 5U) << "to four stations and back";
  EXPECT_GT(duration(script), 1.2 * flight_time(plan));
}

/// Square of 10 m at 2 m/s whose inner corners may be cut `turn` m before them.
InterpretedRoute square(double turn) {
  const std::vector<Vector3d> corners{{0, 0, 9}, {10, 0, 9}, {10, 10, 9}, {0, 10, 9}, {0, 0, 9}};
  InterpretedRoute route;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    InterpretedSegment segment;
    const Vector3d before =
        i > 1 ? Vector3d((corners[i - 2] - corners[i - 1]).normalized()) : Vector3d::Zero();
    segment.start = {corners[i - 1] + turn * before, corners[i - 1]};
    segment.to = corners[i];
    segment.speed = 2.0;
    route.segments.push_back(segment);
  }
  return route;
}

TEST(FlightScript, PassesCornersWithoutAStop) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const Motion motion(plan.vehicle, plan.conditions);
  const double jerk = plan.vehicle.mode.jerk;
  const FlightScript script = make_flight_script(square(1.0), motion);
  double length = 0.0, distance_from_corner = 1e9;
  for (std::size_t i = 0; i < script.size(); ++i) {
    const ScriptedLeg& leg = script[i];
    ASSERT_TRUE(leg.is_piece);
    if (i > 0) {
      EXPECT_EQ(leg.from, script[i - 1].to);
      EXPECT_EQ(leg.begin_speed, script[i - 1].end_speed);
      EXPECT_GT(leg.begin_speed, 0.0) << "no stop on the way";
    }
    EXPECT_LE(leg.end_speed, 2.0 + 1e-9);
    EXPECT_LT((set_point(leg, jerk, 0.0).position - leg.from).norm(), 1e-9);
    EXPECT_LT((set_point(leg, jerk, leg.moving).position - leg.to).norm(), 1e-9);
    length += (leg.to - leg.from).norm();
    distance_from_corner = std::min(distance_from_corner, (leg.to - Vector3d(10, 10, 9)).norm());
    // An abort brakes straight on.
    const double braking = braking_time(leg, jerk, 0.5 * leg.moving);
    const SetPoint rest = braking_point(leg, jerk, 0.5 * leg.moving, braking);
    EXPECT_LT(rest.velocity.norm(), 1e-9);
    EXPECT_NEAR((leg.to - leg.from).normalized().cross(rest.position - leg.from).norm(), 0, 1e-9);
  }
  EXPECT_EQ(script.front().begin_speed, 0.0);
  EXPECT_EQ(script.back().end_speed, 0.0);
  // A parabola between points 1 m before and after a corner of 90 degrees passes it at half of the
  // distance of their chord, sqrt(2) / 4 m, and is 1.6232 m long (its closed form).
  EXPECT_NEAR(distance_from_corner, std::sqrt(2.0) / 4.0, 1e-6);
  EXPECT_NEAR(length, 40.0 - 3.0 * (2.0 - 1.6232), 0.01);
  const double at_full_speed = length / 2.0;
  EXPECT_GT(duration(script), at_full_speed);
  EXPECT_LT(duration(script), at_full_speed + 2.0 / plan.vehicle.mode.acceleration +
                                  plan.vehicle.mode.settle_time + 0.1);
}

TEST(FlightScript, StopsAtCornersThatAreNotPassed) {
  const FlightPlan plan = sample_plan(vehicle_profile("generic"));
  const FlightScript script =
      make_flight_script(square(0.0), Motion(plan.vehicle, plan.conditions));
  ASSERT_EQ(script.size(), 4U);
  for (const ScriptedLeg& leg : script) EXPECT_FALSE(leg.is_piece);
}

}  // namespace
}  // namespace skycap::flight
