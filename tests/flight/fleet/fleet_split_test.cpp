#include "flight/fleet/fleet_split.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/fleet/collection_bound.h"
#include "flight/fleet/fleet_bound.h"
#include "flight/fleet/fleet_costs.h"
#include "tests/flight/fleet/lemon_tours.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"
#include "tests/support/not_empty.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

using Order = std::vector<std::uint32_t>;

/// Returns a problem in a flat world in which times and energies equal distances [m].
FleetProblem flat_problem(std::uint64_t seed, std::size_t capture_points,
                          const std::vector<Vector3d>& pads) {
  std::mt19937_64 random(seed);
  std::vector<Vector3d> point_count;
  for (std::size_t i = 0; i < capture_points; ++i) {
    point_count.push_back(scenes::point_in(random, {Vector3d(0, 0, 0), Vector3d(100, 100, 0)}));
  }
  FleetProblem problem;
  for (const Vector3d& pad : pads) {
    FleetVehicle vehicle{.energy_per_sortie = 1e9, .capture_points_per_sortie = 1000};
    const auto part = [](double length) { return PartCost{length, length, 0.0}; };
    for (const Vector3d& position : point_count) {
      vehicle.out.push_back(part(10.0 + (position - pad).norm()));
      vehicle.capture_point.push_back(part(2.0));
      vehicle.back.push_back(part(20.0 + (position - pad).norm()));
      for (const Vector3d& next : point_count)
        vehicle.legs.push_back(part((next - position).norm()));
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

/// Tries all splits of the order into one run for each vehicle.
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

/// Returns the minimum time of one tour through each set of capture points, without battery limits
/// (Held & Karp 1962). The index is the bit set.
std::vector<double> best_tours(const FleetVehicle& vehicle) {
  const std::size_t count = vehicle.count(), sets = std::size_t{1} << count;
  std::vector<double> leg_costs(sets * count, never), tours(sets, never);
  tours[0] = 0.0;
  for (std::size_t set = 1; set < sets; ++set) {
    for (std::uint32_t last = 0; last < count; ++last) {
      const std::size_t before = set & ~(std::size_t{1} << last);
      if (before == set) continue;
      double leg_cost = never;
      if (before == 0) leg_cost = vehicle.out[last].time;
      for (std::uint32_t from = 0; from < count; ++from) {
        leg_cost =
            std::min(leg_cost, leg_costs[before * count + from] + vehicle.leg(from, last).time);
      }
      leg_costs[set * count + last] = leg_cost += vehicle.capture_point[last].time;
      tours[set] = std::min(tours[set], leg_cost + vehicle.back[last].time);
    }
  }
  return tours;
}

/// Returns the minimum over all assignments of capture points to vehicles.
double optimum(const FleetProblem& problem, FleetGoal goal) {
  const std::size_t sets = std::size_t{1} << problem.count();
  std::vector<double> best(sets, never);  // for each set, with the vehicles so far
  best[0] = 0.0;
  for (const FleetVehicle& vehicle : problem.vehicles) {
    const std::vector<double> tours = best_tours(vehicle);
    std::vector<double> next(sets, never);
    for (std::size_t set = 0; set < sets; ++set) {
      for (std::size_t own = set;; own = (own - 1) & set) {
        const double rest = best[set & ~own], time = tours[own];
        next[set] =
            std::min(next[set], goal == FleetGoal::makespan ? std::max(rest, time) : rest + time);
        if (own == 0) break;
      }
    }
    best = std::move(next);
  }
  return best.back();
}

Order all_capture_points(const FleetSplit& split) {
  Order all;
  for (const FleetPart& part : split.parts) {
    all.insert(all.end(), part.capture_points.begin(), part.capture_points.end());
  }
  std::ranges::sort(all);
  return all;
}

TEST(FleetSplit, MatchesBestCutOfOrder) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FleetProblem problem = flat_problem(seed, 12, {{0, 0, 0}, {50, 0, 0}, {100, 0, 0}});
    const Order order = counted(12);
    for (const FleetGoal goal : {FleetGoal::makespan, FleetGoal::total_flight_time}) {
      const FleetSplit split = split_among(problem, order, goal);
      const double figure = goal == FleetGoal::makespan ? split.makespan : split.total_flight_time;
      EXPECT_NEAR(figure, best_cut(problem, order, 0, goal), 1e-9) << "seed " << seed;
      Order joined;
      for (const FleetPart& part : split.parts) {
        joined.insert(joined.end(), part.capture_points.begin(), part.capture_points.end());
      }
      EXPECT_EQ(joined, order);
    }
  }
}

// The battery is enough for half of the tour. The time equals that of the split into sorties.
TEST(FleetSplit, UsesSeveralSortiesWhenBatteryIsTooSmall) {
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

// Compares with all assignments of nine capture points: the solution and both bounds must match the
// optimum.
TEST(FleetSplit, MatchesOptimumOfSmallCasesAndKeepsBounds) {
  double min_bound = 1.0, min_collected = 1.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const double apart : {0.0, 40.0}) {
      std::vector<Vector3d> pads{{0, 0, 0}, {apart, 0, 0}};
      if (seed % 2 == 0) pads.emplace_back(50, 100, 0);
      const FleetProblem problem = flat_problem(seed, 9, pads);
      const double soonest = optimum(problem, FleetGoal::makespan);
      const double shortest = optimum(problem, FleetGoal::total_flight_time);
      const FleetSplit fast = share_among(problem, counted(9), FleetGoal::makespan);
      EXPECT_NEAR(fast.makespan, soonest, 1e-9) << "seed " << seed;
      EXPECT_EQ(all_capture_points(fast), counted(9));
      const FleetSplit thrifty = share_among(problem, counted(9), FleetGoal::total_flight_time);
      EXPECT_NEAR(thrifty.total_flight_time, shortest, 1e-9) << "seed " << seed;

      const FleetBound bound = fleet_bound(problem, 2.0 * soonest);
      EXPECT_LE(bound.makespan, soonest + 1e-9);
      EXPECT_LE(bound.total_flight_time, shortest + 1e-9);
      min_bound = std::min(min_bound, bound.makespan / soonest);
      const double collected = collection_bound(problem, 1.5 * soonest);
      EXPECT_LE(collected, soonest + 1e-9) << "seed " << seed;
      EXPECT_LE(collection_bound(problem, 0.9 * soonest), 0.9 * soonest + 1e-9);
      min_collected = std::min(min_collected, collected / soonest);
    }
  }
  // Random tours visit some capture points twice, which lowers these ratios.
  EXPECT_GE(min_bound, 0.8);
  EXPECT_GE(min_collected, 0.8);
  RecordProperty("least_bound", std::to_string(min_bound));
  RecordProperty("least_collected", std::to_string(min_collected));
}

// With one vehicle, the tour must not be longer than LEMON's.
TEST(FleetSplit, IsNotLongerThanLemonTourForOneVehicle) {
  double sum = 0.0;
  for (const std::size_t count : {50, 80}) {
    const FleetProblem problem = flat_problem(count, count, {{30, 0, 0}});
    const FleetVehicle& vehicle = problem.vehicles.front();
    const std::size_t point_count = count + 1;  // the pad is the last point
    std::vector<double> costs(point_count * point_count, 0.0);
    for (std::uint32_t i = 0; i < count; ++i) {
      costs[i * point_count + count] = costs[count * point_count + i] = vehicle.out[i].time;
      for (std::uint32_t j = 0; j < count; ++j) costs[i * point_count + j] = vehicle.leg(i, j).time;
    }
    // A landing takes 10 s more than a take-off, and each capture point takes 2 s.
    const double others = 10.0 + 2.0 * static_cast<double>(count);
    const double library = others + lemon_tour(point_count, costs);
    const double ours = share_among(problem, counted(count), FleetGoal::makespan, 2).makespan;
    EXPECT_LE(ours, library + 1e-9) << count << " stations";
    EXPECT_GE(ours, fleet_bound(problem, library).makespan);
    sum += ours / library;
  }
  RecordProperty("mean_of_library", std::to_string(sum / 2.0));
}

// One capture point on each of three sides and one vehicle for each: a vehicle that visits one has
// no time for another.
TEST(CollectionBound, IsTightWhenEveryVehicleHasToFlyFar) {
  FleetProblem problem = flat_problem(1, 3, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  for (FleetVehicle& vehicle : problem.vehicles) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      vehicle.out[i].time = vehicle.back[i].time = 100.0;
      vehicle.capture_point[i].time = 0.0;
      for (std::uint32_t j = 0; j < 3; ++j) vehicle.leg(i, j).time = i == j ? 0.0 : 150.0;
    }
  }
  EXPECT_GT(collection_bound(problem, 300.0), 198.0);
  EXPECT_LE(collection_bound(problem, 300.0), 200.0);
  problem.vehicles.pop_back();  // one of the two vehicles has two capture points
  EXPECT_GT(collection_bound(problem, 400.0), 347.0);
  EXPECT_LE(collection_bound(problem, 400.0), 350.0);
}

TEST(FleetSplit, ImprovesThroughExchangesAndAnnealing) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const FleetProblem problem = flat_problem(seed, 40, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
    const FleetSplit cut = split_among(problem, counted(40), FleetGoal::makespan);
    const FleetSplit better = exchanged(problem, cut, FleetGoal::makespan);
    EXPECT_LT(better.makespan, cut.makespan);
    EXPECT_EQ(all_capture_points(better), counted(40));
    const FleetSplit again = exchanged(problem, cut, FleetGoal::makespan);
    for (std::size_t v = 0; v < 3; ++v)
      EXPECT_EQ(again.parts[v].capture_points, better.parts[v].capture_points);
    const FleetSplit cooled = annealed(problem, cut, FleetGoal::makespan);
    EXPECT_LT(cooled.makespan, cut.makespan);
    EXPECT_EQ(all_capture_points(cooled), counted(40));
    EXPECT_EQ(annealed(problem, cut, FleetGoal::makespan).makespan, cooled.makespan);
  }
}

// Two vehicles with double speed get more capture points than the slow one, but each vehicle gets
// some.
TEST(FleetSplit, AssignsMoreCapturePointsToFasterVehicle) {
  FleetProblem problem = flat_problem(8, 30, {{0, 0, 0}, {0, 0, 0}});
  for (auto* parts : {&problem.vehicles[1].out, &problem.vehicles[1].back,
                      &problem.vehicles[1].capture_point, &problem.vehicles[1].legs}) {
    for (PartCost& part : *parts) part.time *= 0.5;
  }
  const FleetSplit split = share_among(problem, counted(30), FleetGoal::makespan);
  EXPECT_GT(split.parts[1].capture_points.size(), split.parts[0].capture_points.size());
  EXPECT_LT(split.makespan, part_time(problem.vehicles[1], counted(30)));
  EXPECT_FALSE(split.parts[0].capture_points.empty());
}

FleetMember make_member(const Vehicle& vehicle, const Eigen::Vector2d& wind = {0.0, 0.0}) {
  FleetMember member{vehicle, {}};
  member.options.takeoff = {-5, -5, 0};
  member.options.conditions.wind = wind;
  return member;
}

// The minimum cost is a lower bound for straight paths and for paths with a stop at a corner.
// Rest-to-rest motion is faster than the autopilot's braking law, but not twice as fast.
TEST(FleetCosts, AreLowerBoundsForPathsAroundCorner) {
  std::mt19937_64 random(4);
  const Eigen::AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(60, 60, 40));
  for (const Vehicle& vehicle : testing_support::not_empty(vehicle_profiles())) {
    const FleetMember member = make_member(vehicle, {3.0, 1.0});
    const Motion motion(vehicle, member.options.conditions);
    for (int i = 0; i < 2000; ++i) {
      std::vector<CapturePoint> capture_points(2);
      for (CapturePoint& capture_point : capture_points) {
        capture_point.view = {scenes::point_in(random, box), Vector3d(1, 0, 0)};
      }
      const Vector3d corner = scenes::point_in(random, box);
      const Vector3d from = capture_points[0].view.position, to = capture_points[1].view.position;
      const double min = lower_bound_costs(capture_points, member).leg(0, 1).time;
      const double straight = motion.leg_time(to - from);
      EXPECT_LE(min, straight + 1e-9);
      EXPECT_GT(min, 0.5 * straight);
      EXPECT_LE(min, motion.leg_time(corner - from) + motion.leg_time(to - corner));
    }
  }
}

// The straight line is blocked by a ball. All paths around it, with one or two corners, take at
// least the lower bound.
TEST(FleetCosts, AreLowerBoundsForPathsAroundBall) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(40, 40, 20));
  int compared = 0;
  for (const Vehicle& vehicle : testing_support::not_empty(vehicle_profiles())) {
    const FleetMember member = make_member(vehicle);
    const Motion motion(vehicle, {});
    for (int i = 0; i < 4000; ++i) {
      std::vector<CapturePoint> capture_points(2);
      for (CapturePoint& capture_point : capture_points) {
        capture_point.view = {scenes::point_in(random, box), Vector3d(1, 0, 0)};
      }
      const Vector3d from = capture_points[0].view.position, to = capture_points[1].view.position;
      const Vector3d centre = from + uniform(random) * (to - from);
      const double radius = 2.0 * uniform(random);
      std::vector<Vector3d> leg_cost{from};
      for (int corners = 1 + i % 2; corners > 0; --corners) {
        const Vector3d aside = scenes::point_in(random, {Vector3d(-4, -4, -4), Vector3d(4, 4, 4)});
        leg_cost.push_back(centre + aside);
      }
      leg_cost.push_back(to);
      double time = 0.0, nearest_by = never;
      for (std::size_t k = 1; k < leg_cost.size(); ++k) {
        time += motion.leg_time(leg_cost[k] - leg_cost[k - 1]) + (k > 1 ? corner_hold : 0.0);
        const double squared = nearest({leg_cost[k - 1], leg_cost[k]}, centre).squared_distance;
        nearest_by = std::min(nearest_by, std::sqrt(squared));
      }
      if (nearest_by < radius) continue;
      ++compared;
      const ClearanceDeficits clearance_deficits{{0.0, 0.0}, {0.0, radius, radius, 0.0}};
      EXPECT_LE(lower_bound_costs(capture_points, member, clearance_deficits).leg(0, 1).time,
                time + 1e-9);
    }
  }
  EXPECT_GT(compared, 1000);
}

}  // namespace
}  // namespace skycap::flight
