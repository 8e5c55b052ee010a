#include "flight/fleet/verified_costs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "geometry/pose/pose.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

using Order = std::vector<std::uint32_t>;

/// Returns four buildings with streets between them.
Obstacles block() {
  Obstacles obstacles;
  for (const double x : {-40.0, 10.0}) {
    for (const double y : {-40.0, 10.0}) {
      geometry::append(obstacles.mesh, scenes::box({x, y, 0}, {x + 30, y + 30, 25}));
    }
  }
  obstacles.ground_height = 0.0;
  return obstacles;
}

/// Returns capture points in the streets and above the roofs, with random directions.
std::vector<CapturePoint> random_capture_points(const FreeSpace& space, std::uint32_t count) {
  std::mt19937_64 random(7);
  std::vector<CapturePoint> capture_points;
  while (capture_points.size() < count) {
    const Vector3d position =
        scenes::point_in(random, {Vector3d(-55, -55, 5), Vector3d(55, 55, 35)});
    if (!space.is_free({position, position}, 2.1)) continue;
    const Vector3d target = scenes::point_in(random, {Vector3d(-40, -40, 0), Vector3d(40, 40, 4)});
    capture_points.push_back({geometry::look_at(position, target), 1.0, 1,
                              static_cast<std::uint32_t>(capture_points.size())});
  }
  return capture_points;
}

std::vector<FleetMember> members() {
  std::vector<FleetMember> members;
  for (const Vector3d& pad : {Vector3d(-65, 0, 0), Vector3d(0, 70, 0)}) {
    FleetMember& member = members.emplace_back();
    member.vehicle = vehicle_profile(members.size() == 1 ? "m350_rtk" : "generic");
    member.options.takeoff = pad;
    member.options.conditions.wind = {2.0, 1.0};
    member.options.returns = ReturnOptions{{member.vehicle.autopilot}, 45.0};
  }
  return members;
}

class VerifiedBlockCosts : public testing::Test {
 protected:
  KnownSpace space{block()};
  std::vector<FleetMember> fleet = members();
};

// The costs used for the selection of routes equal the times of the planned routes, for any order
// and number of sorties.
TEST_F(VerifiedBlockCosts, MatchPlannedRouteTimes) {
  constexpr std::uint32_t count = 14;
  const std::vector<CapturePoint> capture_points = random_capture_points(space, count);
  std::mt19937_64 random(3);
  for (const double reserve : {0.2, 0.7}) {
    for (FleetMember& member : fleet) member.options.conditions.reserve = reserve;
    VerifiedCosts costs(capture_points, fleet, space);
    EXPECT_TRUE(costs.unreached().empty());
    std::size_t sorties = 0;
    for (int trial = 0; trial < 4; ++trial) {
      Order order(count);
      std::iota(order.begin(), order.end(), 0U);
      std::ranges::shuffle(order, random);
      for (std::size_t v = 0; v < fleet.size(); ++v) {
        costs.verify_legs({.parts = {{order, 0.0}}});
        EXPECT_FALSE(costs.verify_legs({.parts = {{order, 0.0}}}));
        const Route route = plan_route(costs.ordered_capture_points(v, order), fleet[v].vehicle,
                                       space, nullptr, fleet[v].options);
        ASSERT_EQ(route.capture_points.size(), count);
        EXPECT_NEAR(part_time(costs.problem().vehicles[v], order), route.duration, 1e-9);
        sorties = std::max(sorties, route.sorties.size());
      }
    }
    EXPECT_EQ(sorties > 1, reserve > 0.5);
  }
}

TEST_F(VerifiedBlockCosts, AreNotBelowLowerBoundAndIndependentOfThreadCount) {
  const std::vector<CapturePoint> capture_points = random_capture_points(space, 24);
  const VerifiedCosts one(capture_points, fleet, space, 1), two(capture_points, fleet, space, 2);
  for (std::size_t v = 0; v < fleet.size(); ++v) {
    const FleetVehicle &costs = one.problem().vehicles[v], &same = two.problem().vehicles[v];
    const FleetVehicle& lower_bound = one.lower_bound().vehicles[v];
    std::size_t verified = 0;
    for (std::uint32_t i = 0; i < 24; ++i) {
      EXPECT_GE(costs.out[i].time, lower_bound.out[i].time - 1e-9);
      EXPECT_GE(costs.back[i].time, lower_bound.back[i].time - 1e-9);
      EXPECT_EQ(costs.out[i].energy, same.out[i].energy);
      for (std::uint32_t j = 0; j < 24; ++j) {
        EXPECT_GE(costs.leg(i, j).time, lower_bound.leg(i, j).time - 1e-9);
        EXPECT_EQ(costs.leg(i, j).time, same.leg(i, j).time);
        EXPECT_EQ(costs.leg(i, j).energy, same.leg(i, j).energy);
        if (costs.leg(i, j).time > lower_bound.leg(i, j).time) ++verified;
      }
    }
    EXPECT_GE(verified, 24U * 10U);  // at least one path to each neighbour of each capture point
  }
}

// Inside a building.
TEST_F(VerifiedBlockCosts, AreInfiniteForUnreachableCapturePoints) {
  std::vector<CapturePoint> capture_points = random_capture_points(space, 6);
  capture_points[2].view.position = {-25, -25, 10};
  const VerifiedCosts costs(capture_points, fleet, space);
  ASSERT_EQ(costs.unreached().size(), 1U);
  EXPECT_EQ(costs.unreached()[0].capture_point.view_index, 2U);
  for (const FleetVehicle& vehicle : costs.problem().vehicles) {
    const Order one{2}, other{3};
    EXPECT_TRUE(std::isinf(part_time(vehicle, one)));
    EXPECT_LT(part_time(vehicle, other), 1e4);
  }
}

}  // namespace
}  // namespace skycap::flight
