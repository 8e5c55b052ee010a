#include "flight/fleet/fleet_split.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/fleet/collection_bound.h"
#include "flight/fleet/fleet_bound.h"
#include "flight/fleet/fleet_costs.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

using Order = std::vector<std::uint32_t>;

constexpr double never = std::numeric_limits<double>::infinity();

/// A flat world: times are metres, and so are energies.
FleetProblem flat_problem(std::uint64_t seed, std::size_t stations,
                          const std::vector<Vector3d>& pads) {
  std::mt19937_64 random(seed);
  std::vector<Vector3d> places;
  for (std::size_t i = 0; i < stations; ++i) {
    places.push_back(scenes::point_in(random, {Vector3d(0, 0, 0), Vector3d(100, 100, 0)}));
  }
  FleetProblem problem;
  for (const Vector3d& pad : pads) {
    FleetVehicle vehicle{.energy_per_sortie = 1e9, .stations_per_sortie = 1000};
    const auto part = [](double length) { return PartCost{length, length, 0.0}; };
    for (const Vector3d& place : places) {
      vehicle.out.push_back(part(10.0 + (place - pad).norm()));
      vehicle.station.push_back(part(2.0));
      vehicle.back.push_back(part(20.0 + (place - pad).norm()));
      for (const Vector3d& next : places) vehicle.legs.push_back(part((next - place).norm()));
    }
    problem.vehicles.push_back(std::move(vehicle));
  }
  return problem;
}

Order counted(std::size_t count) {
  Order order(count);
  std::iota(order.begin(), order.end(), 0U);
  return order;
}

/// Every way of cutting the order in as many runs as there are vehicles.
double best_cut(const FleetProblem& problem, std::span<const std::uint32_t> order, std::size_t v,
                FleetGoal goal) {
  if (v + 1 == problem.vehicles.size()) return part_time(problem.vehicles[v], order);
  double best = never;
  for (std::size_t cut = 0; cut <= order.size(); ++cut) {
    const double own = part_time(problem.vehicles[v], order.first(cut));
    const double rest = best_cut(problem, order.subspan(cut), v + 1, goal);
    best = std::min(best, goal == FleetGoal::makespan ? std::max(own, rest) : own + rest);
  }
  return best;
}

/// Over all orders, and so over all ways of sharing the stations out.
FleetBound optimum(const FleetProblem& problem) {
  FleetBound best{never, never};
  Order order = counted(problem.count());
  do {
    best.makespan = std::min(best.makespan, best_cut(problem, order, 0, FleetGoal::makespan));
    best.flown = std::min(best.flown, best_cut(problem, order, 0, FleetGoal::flown));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

Order all_stations(const FleetSplit& split) {
  Order all;
  for (const FleetPart& part : split.parts) {
    all.insert(all.end(), part.stations.begin(), part.stations.end());
  }
  std::ranges::sort(all);
  return all;
}

TEST(FleetSplit, IsTheBestOfAllCutsOfItsOrder) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FleetProblem problem = flat_problem(seed, 12, {{0, 0, 0}, {50, 0, 0}, {100, 0, 0}});
    const Order order = counted(12);
    for (const FleetGoal goal : {FleetGoal::makespan, FleetGoal::flown}) {
      const FleetSplit split = split_among(problem, order, goal);
      const double figure = goal == FleetGoal::makespan ? split.makespan : split.flown;
      EXPECT_NEAR(figure, best_cut(problem, order, 0, goal), 1e-9) << "seed " << seed;
      Order joined;
      for (const FleetPart& part : split.parts) {
        joined.insert(joined.end(), part.stations.begin(), part.stations.end());
      }
      EXPECT_EQ(joined, order);
    }
  }
}

// A battery that holds half of the tour: the time is that of the split into sorties.
TEST(FleetSplit, FliesSeveralSortiesWhereTheBatteryAsksForThem) {
  FleetProblem problem = flat_problem(3, 10, {{0, 0, 0}});
  const Order order = counted(10);
  const double at_once = part_time(problem.vehicles[0], order);
  problem.vehicles[0].energy_per_sortie = 0.7 * at_once;
  const double in_parts = part_time(problem.vehicles[0], order);
  EXPECT_GT(in_parts, at_once);
  double best = never;
  for (std::size_t cut = 1; cut < 10; ++cut) {
    const auto all = std::span(order);
    best = std::min(best, part_time(problem.vehicles[0], all.first(cut)) +
                              part_time(problem.vehicles[0], all.subspan(cut)));
  }
  EXPECT_NEAR(in_parts, best, 1e-9);
  problem.vehicles[0].energy_per_sortie = 10.0;
  EXPECT_EQ(part_time(problem.vehicles[0], order), never);
  EXPECT_TRUE(share_among(problem, order, FleetGoal::makespan).parts.empty());
}

// Against all orders of seven stations: the bound is one, and what is found is near the best.
TEST(FleetSplit, IsNearTheOptimumOfSmallCasesAndTheBoundHolds) {
  double worst = 1.0, least_bound = 1.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const double apart : {0.0, 40.0}) {
      const FleetProblem problem = flat_problem(seed, 7, {{0, 0, 0}, {apart, 0, 0}});
      const FleetBound best = optimum(problem), bound = fleet_bound(problem, 2.0 * best.makespan);
      EXPECT_LE(bound.makespan, best.makespan + 1e-9);
      EXPECT_LE(bound.flown, best.flown + 1e-9);
      EXPECT_GE(bound.makespan, 0.6 * best.makespan);
      least_bound = std::min(least_bound, bound.makespan / best.makespan);
      const FleetSplit fast = share_among(problem, counted(7), FleetGoal::makespan);
      EXPECT_GE(fast.makespan, best.makespan - 1e-9);
      EXPECT_EQ(all_stations(fast), counted(7));
      const FleetSplit thrifty = share_among(problem, counted(7), FleetGoal::flown);
      EXPECT_GE(thrifty.flown, best.flown - 1e-9);
      worst = std::max({worst, fast.makespan / best.makespan, thrifty.flown / best.flown});
    }
  }
  EXPECT_LE(worst, 1.001);
  RecordProperty("least_bound", std::to_string(least_bound));
}

// No fleet is faster than what all vehicles could collect, and the best is near it.
TEST(CollectionBound, IsNoMoreThanTheOptimumAndNearIt) {
  double least = 1.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const double apart : {0.0, 40.0}) {
      const FleetProblem problem = flat_problem(seed, 7, {{0, 0, 0}, {apart, 0, 0}});
      const double best = optimum(problem).makespan;
      const double bound = collection_bound(problem, 1.5 * best);
      EXPECT_LE(bound, best + 1e-9) << "seed " << seed;
      EXPECT_LE(collection_bound(problem, 0.9 * best), 0.9 * best + 1e-9);
      least = std::min(least, bound / best);
    }
  }
  EXPECT_GE(least, 0.85);  // tours that come to a station twice cost the rest
}

// A station on each of three sides, a vehicle for each: who flies to one has time for no other.
TEST(CollectionBound, SeesThatEveryVehicleHasToFlyFar) {
  FleetProblem problem = flat_problem(1, 3, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  for (FleetVehicle& vehicle : problem.vehicles) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      vehicle.out[i].time = vehicle.back[i].time = 100.0;
      vehicle.station[i].time = 0.0;
      for (std::uint32_t j = 0; j < 3; ++j) vehicle.leg(i, j).time = i == j ? 0.0 : 150.0;
    }
  }
  EXPECT_GT(collection_bound(problem, 300.0), 198.0);
  EXPECT_LE(collection_bound(problem, 300.0), 200.0);
  problem.vehicles.pop_back();  // one of two has two stations
  EXPECT_GT(collection_bound(problem, 400.0), 347.0);
  EXPECT_LE(collection_bound(problem, 400.0), 350.0);
}

TEST(FleetSplit, IsNoWorseAfterExchanges) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const FleetProblem problem = flat_problem(seed, 40, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
    const FleetSplit cut = split_among(problem, counted(40), FleetGoal::makespan);
    const FleetSplit better = exchanged(problem, cut, FleetGoal::makespan);
    EXPECT_LT(better.makespan, cut.makespan);
    EXPECT_EQ(all_stations(better), counted(40));
    const FleetSplit again = exchanged(problem, cut, FleetGoal::makespan);
    for (std::size_t v = 0; v < 3; ++v)
      EXPECT_EQ(again.parts[v].stations, better.parts[v].stations);
    const FleetSplit cooled = annealed(problem, cut, FleetGoal::makespan);
    EXPECT_LT(cooled.makespan, better.makespan);
    EXPECT_EQ(all_stations(cooled), counted(40));
    EXPECT_EQ(annealed(problem, cut, FleetGoal::makespan).makespan, cooled.makespan);
  }
}

// Two that fly twice as fast get more to do than one that does not, but each some.
TEST(FleetSplit, GivesMoreToTheFaster) {
  FleetProblem problem = flat_problem(8, 30, {{0, 0, 0}, {0, 0, 0}});
  for (auto* parts : {&problem.vehicles[1].out, &problem.vehicles[1].back,
                      &problem.vehicles[1].station, &problem.vehicles[1].legs}) {
    for (PartCost& part : *parts) part.time *= 0.5;
  }
  const FleetSplit split = share_among(problem, counted(30), FleetGoal::makespan);
  EXPECT_GT(split.parts[1].stations.size(), split.parts[0].stations.size());
  EXPECT_LT(split.makespan, part_time(problem.vehicles[1], counted(30)));
  EXPECT_FALSE(split.parts[0].stations.empty());
}

// Where the camera always looks north a leg takes what the motion says, whichever stations it
// joins.
TEST(FleetCosts, OfStraightLegsAreThoseOfTheMotion) {
  std::mt19937_64 random(5);
  std::vector<Station> stations(6);
  for (Station& station : stations) {
    station.view = {scenes::point_in(random, {Vector3d(0, 0, 10), Vector3d(60, 60, 40)}),
                    Vector3d(0, 1, 0)};
  }
  const FleetMember member{Motion(vehicle_profiles()[0], {}), Vector3d(-5, -5, 0), 5.0};
  const FleetVehicle costs = straight_costs(stations, member);
  const FleetVehicle least = least_costs(stations, member);
  for (std::uint32_t i = 0; i < 6; ++i) {
    for (std::uint32_t j = 0; j < 6; ++j) {
      if (i == j) continue;
      const Vector3d way = stations[j].view.position - stations[i].view.position;
      EXPECT_NEAR(costs.leg(i, j).time, member.motion.leg_time(way), 1e-12);
      EXPECT_NEAR(costs.leg(i, j).energy, member.motion.leg_energy(way, costs.leg(i, j).time),
                  1e-9);
      // From rest to rest is faster than the autopilot's braking, but not twice as fast.
      EXPECT_GT(least.leg(i, j).time, 0.5 * costs.leg(i, j).time);
    }
  }
}

// The least cost is one whatever way is flown: with stops in corners, too.
TEST(FleetCosts, NoWayRoundACornerIsFasterThanTheLeast) {
  std::mt19937_64 random(4);
  const Eigen::AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(60, 60, 40));
  for (const Vehicle& vehicle : vehicle_profiles()) {
    const FleetMember member{Motion(vehicle, {.wind = {3.0, 1.0}}), Vector3d(-5, -5, 0), 5.0};
    for (int i = 0; i < 2000; ++i) {
      std::vector<Station> stations(2);
      for (Station& station : stations) {
        station.view = {scenes::point_in(random, box), Vector3d(1, 0, 0)};
      }
      const Vector3d corner = scenes::point_in(random, box);
      const Vector3d from = stations[0].view.position, to = stations[1].view.position;
      const double bent =
          member.motion.leg_time(corner - from) + member.motion.leg_time(to - corner);
      const double least = least_costs(stations, member).leg(0, 1).time;
      EXPECT_LE(least, straight_costs(stations, member).leg(0, 1).time + 1e-9);
      EXPECT_LE(least, bent);
    }
  }
}

// A place of the straight line is not free: whatever way is flown round the ball about it, with one
// corner or with two, takes no less.
TEST(FleetCosts, NoWayRoundABallIsFasterThanTheLeast) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(40, 40, 20));
  int compared = 0;
  for (const Vehicle& vehicle : vehicle_profiles()) {
    FleetMember member{Motion(vehicle, {}), Vector3d(-5, -5, 0), 5.0};
    for (int i = 0; i < 4000; ++i) {
      std::vector<Station> stations(2);
      for (Station& station : stations) {
        station.view = {scenes::point_in(random, box), Vector3d(1, 0, 0)};
      }
      const Vector3d from = stations[0].view.position, to = stations[1].view.position;
      const Vector3d centre = from + uniform(random) * (to - from);
      const double radius = 2.0 * uniform(random);
      std::vector<Vector3d> way{from};
      for (int corners = 1 + i % 2; corners > 0; --corners) {
        const Vector3d aside = scenes::point_in(random, {Vector3d(-4, -4, -4), Vector3d(4, 4, 4)});
        way.push_back(centre + aside);
      }
      way.push_back(to);
      double time = 0.0, nearest_by = never;
      for (std::size_t k = 1; k < way.size(); ++k) {
        time += member.motion.leg_time(way[k] - way[k - 1]) + (k > 1 ? corner_hold : 0.0);
        const double squared = nearest({way[k - 1], way[k]}, centre).squared_distance;
        nearest_by = std::min(nearest_by, std::sqrt(squared));
      }
      if (nearest_by < radius) continue;
      ++compared;
      member.shortfalls = {{0.0, 0.0}, {0.0, radius, radius, 0.0}};
      EXPECT_LE(least_costs(stations, member).leg(0, 1).time, time + 1e-9);
    }
  }
  EXPECT_GT(compared, 1000);
}

}  // namespace
}  // namespace skycap::flight
