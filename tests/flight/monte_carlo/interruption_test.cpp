// Flights that are interrupted at any time, for example by a return, by a lost link or by the
// battery. What is verified of a route must cover the braking.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/export.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpret.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/monte_carlo/flight_script.h"
#include "flight/monte_carlo/simulated_flight.h"
#include "flight/rtl/return_verification.h"
#include "geometry/random_numbers.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double clearance = 2.0, position_error = 0.1, tracking_error = 0.3;

void add(geometry::Mesh& mesh, const geometry::Mesh& part) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
}

/// A box between two walls.
Obstacles box_and_walls() {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({-4, -4, 0}, {4, 4, 6});
  add(obstacles.mesh, scenes::box({15, -12, 0}, {15.4, 12, 14}));
  add(obstacles.mesh, scenes::box({-12, 15, 0}, {12, 15.4, 14}));
  obstacles.ground_height = 0.0;
  return obstacles;
}

CapturePoint station(const Vector3d& position, std::uint32_t index) {
  return {.view = geometry::look_at(position, {0, 0, 3}), .view_index = index};
}

/// Flight whose legs end at the clearance from the walls, the box and the ground.
class InterruptedFlight : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    RouteOptions options;
    options.takeoff = {-60, -40, 0};
    options.clearance = {.vehicle_radius = vehicle_.radius,
                         .position_error = position_error,
                         .tracking_error = tracking_error,
                         .map_error = 0.1,
                         .margin = 0.0};
    options.clearance.margin = clearance - options.clearance.total();
    options.returns = ReturnOptions{{vehicle_.autopilot}, 40.0};
    // Towards a wall, down to the ground, towards the other wall, down to the box, and short legs.
    const std::vector<Vector3d> positions{
        {-10, -9, 9},       {12.97, -9, 9}, {12.97, -9, 2.03}, {10, 9, 9},       {9, 12.97, 9},
        {8.5, 12.97, 2.03}, {0, 6.03, 10},  {0, 6.03, 2.5},    {-6.03, 0, 2.03}, {-9, 3, 5},
        {-9.6, 3.2, 2.031}, {0, 0, 14},     {0, 0, 8.03}};
    std::vector<CapturePoint> stations;
    for (const Vector3d& position : positions) {
      stations.push_back(station(position, static_cast<std::uint32_t>(stations.size())));
    }
    const Route route = plan_route(stations, vehicle_, space_, &pad_space_, options);
    ASSERT_EQ(route.sorties.size(), 1U);
    ASSERT_TRUE(route.unreached.empty()) << route.unreached.front().reason;
    const FlightPlan plan =
        flight_plan(route, 0, "walls", {{51.753458, -1.254022, 111.5}, 46.7}, site_);
    const Format format = vehicle_.autopilot == AutopilotType::dji   ? Format::kmz
                          : vehicle_.autopilot == AutopilotType::px4 ? Format::plan
                                                                     : Format::waypoints;
    const InterpretedRoute flown = interpret(write(plan, format), format, make_flight_facts(plan));
    ASSERT_TRUE(flown.problems.empty()) << flown.problems.front();
    const RouteVerification verification =
        verify(flown, space_, pad_space_, clearance - rounding_bound, clearance + 1.0);
    ASSERT_TRUE(verification.problems.empty()) << verification.problems.front();
    script_ = make_flight_script(flown, motion());
    rtl_profile_ = plan.verified_returns().rtl_profile;
  }

  Motion motion() const { return {vehicle_, {.cruise_speed = 4.0}}; }

  /// Returns a time of an interruption. Every second one is shortly before a stop.
  double random_time(geometry::RandomNumbers& random) const {
    const double anywhere = random.between(0.0, duration(script_));
    const std::size_t leg =
        static_cast<std::size_t>(random.between(0.0, static_cast<double>(script_.size()) - 0.001));
    const double before = random.between(0.0, 2.5);
    if (random.uniform() < 0.5) return anywhere;
    double end = 0.0;
    for (std::size_t i = 0; i <= leg; ++i) {
      end += script_[i].moving + (i < leg ? script_[i].wait : 0.0);
    }
    return std::max(0.0, end - before);
  }

  const Vehicle vehicle_ = vehicle_profile(GetParam());
  const Obstacles site_ = box_and_walls();
  const KnownSpace space_{site_}, pad_space_{without_ground(site_)};
  FlightScript script_;
  RtlProfile rtl_profile_;
};

INSTANTIATE_TEST_SUITE_P(Interruption, InterruptedFlight,
                         testing::Values("generic", "generic_ardupilot", "m350_rtk"),
                         [](const auto& test) { return std::string(test.param); });

// Property: a flight of a verified route keeps the clearance minus the errors of the budget,
// whenever it is interrupted, in wind and with navigation errors.
TEST_P(InterruptedFlight, KeepsRequiredDistance) {
  const SimulatedMission mission{script_, motion(), rtl_profile_};
  const double limit = return_clearance(clearance) - rounding_bound - position_error -
                       tracking_error - stop_overshoot(vehicle_);
  const std::vector<ClearanceCriterion> criteria{{"the site", space_, pad_space_, limit, 0.0}};
  const char* asked = std::getenv("INTERRUPTIONS");
  const std::uint64_t count = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 1500;
  geometry::RandomNumbers random(11, 0);
  for (std::uint64_t i = 0; i < count; ++i) {
    FlightDraw draw{.seed = 11, .number = i + 1, .return_time = random_time(random)};
    const double east = random.between(-3.5, 3.5), north = random.between(-3.5, 3.5);
    draw.wind = {east, north};
    draw.position_error = position_error;
    const SimulatedFlight flight = fly(mission, draw, criteria, 4.0);
    const NearestApproach& nearest = flight.nearest[0];
    ASSERT_GE(nearest.closest.distance, limit)
        << "interrupted after " << *draw.return_time << " s, nearest after " << nearest.time
        << " s, wind " << east << ", " << north;
  }
}

// Property: in calm air, an interrupted vehicle strays from its leg by no more than the tracking
// error, beside the distance by which its autopilot passes a stop.
TEST_P(InterruptedFlight, BrakesWithinTrackingError) {
  const SimulatedMission mission{script_, motion(), rtl_profile_};
  for (double time = 0.0; time < duration(script_); time += 0.37) {
    FlightDraw draw{.seed = 11, .number = 1, .return_time = {}};
    draw.return_time = time;
    const SimulatedFlight flight = fly(mission, draw, {}, 0.0);
    ASSERT_LE(flight.off_line, tracking_error + stop_overshoot(vehicle_)) << time;
  }
}

TEST_P(InterruptedFlight, StaysOnTheGroundAfterLanding) {
  const SimulatedMission mission{script_, motion(), rtl_profile_};
  FlightDraw draw{.seed = 11, .number = 1, .return_time = {}};
  if (script_.back().wait == 0.0) return;  // The flight ends when the vehicle touches the ground.
  const SimulatedFlight whole = fly(mission, draw, {}, 0.0);
  draw.return_time = duration(script_) - 0.5 * script_.back().wait;
  const SimulatedFlight interrupted = fly(mission, draw, {}, 0.0);
  EXPECT_EQ(interrupted.time, whole.time);
  EXPECT_EQ(interrupted.energy, whole.energy);
}

/// Two legs with a corner at the origin that is passed, flown with `speed` [m/s]. The vehicle of
/// the second leg starts up to 0.3 m before the corner.
InterpretedRoute passed_corner(const Vehicle& vehicle, double speed) {
  InterpretedSegment first, second;
  first.start = {{-20, 0, 10}, {-20, 0, 10}};
  first.to = {0, 0, 10};
  first.to_item = "item 1";
  first.braking = stopping_distance(vehicle, {speed, 0, 0});
  second.start = {{-0.3, 0, 10}, {0, 0, 10}};
  second.to = {0, -20, 10};
  InterpretedRoute route;
  route.segments = {first, second};
  return route;
}

// Known answer: the wall is 5 m behind the corner. A vehicle of 3 m/s^2 at 4 m/s stops after 2.67
// m, at a distance of 2.33 m, and at 6 m/s after 6 m.
TEST(Interruption, VerifiesBrakingBeyondPassedCorners) {
  Obstacles wall;
  wall.mesh = scenes::box({5, -30, 0}, {6, 30, 20});
  const KnownSpace space(wall);
  const Vehicle& vehicle = vehicle_profile("m350_rtk");
  EXPECT_NEAR(stopping_distance(vehicle, {4, 0, 0}), 16.0 / 6.0, 1e-12);
  EXPECT_NEAR(stopping_distance(vehicle_profile("generic_ardupilot"), {4, 0, 0}), 4.45, 1e-12);
  // The braking paths between the legs end on an arc, which the proof covers by its height.
  const RouteVerification slow = verify(passed_corner(vehicle, 3.5), space, space, 2.0, 5.0);
  EXPECT_TRUE(slow.problems.empty());
  const RouteVerification fast = verify(passed_corner(vehicle, 6.0), space, space, 2.0, 5.0);
  ASSERT_EQ(fast.problems.size(), 1U);
  EXPECT_THAT(fast.problems.front(),
              HasSubstr("braking beyond item 1 if the flight is interrupted: 0.00 m from"));
}

}  // namespace
}  // namespace skycap::flight
