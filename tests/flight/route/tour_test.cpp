#include "flight/route/tour.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "flight/route/sortie_split.h"
#include "tests/flight/scenes.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> positions(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::vector<Vector3d> result;
  result.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    result.push_back(scenes::point_in(random, {Vector3d::Zero(), Vector3d(60, 60, 20)}));
  }
  return result;
}

Tour compute_tour(const std::vector<Vector3d>& where) {
  return plan_tour(static_cast<std::uint32_t>(where.size()),
                   [&](std::uint32_t a, std::uint32_t b) { return (where[a] - where[b]).norm(); });
}

double compute_cost(const std::vector<Vector3d>& where, const std::vector<std::uint32_t>& order) {
  double sum = 0.0;
  std::uint32_t at = 0;
  for (const std::uint32_t next : order)
    sum += (where[next] - where[std::exchange(at, next)]).norm();
  return sum + (where[0] - where[at]).norm();
}

TEST(Tour, VisitsEveryPositionOnceAtStatedCost) {
  const auto where = positions(1, 100);
  const Tour tour = compute_tour(where);
  std::vector<std::uint32_t> sorted = tour.order;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> all(99);
  std::iota(all.begin(), all.end(), 1U);
  EXPECT_EQ(sorted, all);
  EXPECT_NEAR(tour.cost, compute_cost(where, tour.order), 1e-9);
  EXPECT_EQ(compute_tour(where).order, tour.order);
}

// Compares with all 40,320 orders of nine positions: the bound is valid, and the tour is close to
// the optimum.
TEST(Tour, IsNearOptimumOfSmallCasesAndKeepsBound) {
  double worst = 1.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto where = positions(seed, 9);
    std::vector<std::uint32_t> order(8);
    std::iota(order.begin(), order.end(), 1U);
    double best = compute_cost(where, order);
    while (std::next_permutation(order.begin(), order.end())) {
      best = std::min(best, compute_cost(where, order));
    }
    const Tour tour = compute_tour(where);
    EXPECT_GE(tour.cost, best - 1e-9);
    EXPECT_LE(tour.lower_bound, best + 1e-9);
    EXPECT_GT(tour.lower_bound, 0.95 * best);  // the Held-Karp bound is usually within 1%
    worst = std::max(worst, tour.cost / best);
  }
  EXPECT_LE(worst, 1.05);
}

TEST(Tour, HasSmallGapToBoundForManyPositions) {
  const Tour tour = compute_tour(positions(5, 150));
  EXPECT_LE(tour.cost, 1.08 * tour.lower_bound);  // 2-opt with Or-opt is about 5% above the optimum
}

TEST(Tour, HandlesOneToThreePositions) {
  EXPECT_TRUE(compute_tour(positions(1, 1)).order.empty());
  EXPECT_EQ(compute_tour(positions(1, 2)).order, std::vector<std::uint32_t>{1});
  EXPECT_EQ(compute_tour(positions(1, 3)).order.size(), 2U);
}

/// Returns the minimum time for the capture points `first` to `last` in one sortie. Infinite if the
/// energy is insufficient from all pads.
double best_sortie(const SplitProblem& problem, std::size_t first, std::size_t last) {
  double best = std::numeric_limits<double>::infinity();
  for (const SplitProblem::Pad& pad : problem.pads) {
    bool is_possible = last - first + 1 <= problem.capture_points_per_sortie;
    std::size_t waypoints = pad.out[first].waypoints + pad.back[last].waypoints;
    for (std::size_t i = first; i <= last; ++i) {
      waypoints += problem.capture_point[i].waypoints;
      if (i > first) waypoints += problem.leg[i - 1].waypoints;
    }
    is_possible &= waypoints <= problem.waypoints_per_sortie;
    double energy = pad.out[first].energy, time = pad.out[first].time;
    for (std::size_t i = first; i <= last; ++i) {
      if (i > first) energy += problem.leg[i - 1].energy, time += problem.leg[i - 1].time;
      energy += problem.capture_point[i].energy, time += problem.capture_point[i].time;
      is_possible &= energy + pad.back[i].energy <= problem.energy_per_sortie;
    }
    if (is_possible) best = std::min(best, time + pad.back[last].time);
  }
  return best;
}

/// Tries all subsets of the gaps between capture points, as an exhaustive reference for the split.
double best_by_trying_all(const SplitProblem& problem) {
  const std::size_t count = problem.capture_point.size();
  if (count == 0) return 0.0;
  double best = std::numeric_limits<double>::infinity();
  for (std::uint32_t cuts = 0; cuts < 1U << (count - 1); ++cuts) {
    double total = 0.0;
    for (std::size_t first = 0; first < count;) {
      std::size_t last = first;
      while (last + 1 < count && (cuts >> last & 1) == 0) ++last;
      total += best_sortie(problem, first, last);
      first = last + 1;
    }
    best = std::min(best, total);
  }
  return best;
}

TEST(SortieSplit, MatchesBestOfAllSplits) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(1.0, 10.0);
  int split_cases = 0;
  std::set<std::uint32_t> pads_used;
  for (int round = 0; round < 60; ++round) {
    SplitProblem problem;
    problem.pads.resize(1 + round % 3);
    for (int i = 0; i < 10; ++i) {
      for (SplitProblem::Pad& pad : problem.pads) {
        const double home = uniform(random);
        const auto corners = static_cast<std::size_t>(i + round) % 3;
        pad.out.push_back({home, home, 0.0, 1 + corners});
        pad.back.push_back({home, home, 0.0, 1 + corners});
      }
      problem.capture_point.push_back({1, 1, 0.0, 1});
      const double time = uniform(random);
      const auto corners = static_cast<std::size_t>(i * round) % 2;
      if (i > 0) problem.leg.push_back({time, uniform(random), 0.0, corners});
    }
    if (round % 2 == 1) problem.waypoints_per_sortie = 8;
    problem.energy_per_sortie = 26;
    problem.capture_points_per_sortie = 4;
    const double best = best_by_trying_all(problem);
    const SortieSplit split = split_into_sorties(problem);
    ASSERT_FALSE(split.sorties.empty());
    EXPECT_NEAR(split.time, best, 1e-9);
    EXPECT_LE(split.time_bound, best + 1e-9);
    split_cases += split.sorties.size() > 3 ? 1 : 0;
    double time = 0.0;
    for (const SortieRange& sortie : split.sorties) {
      SplitProblem alone = problem;
      alone.pads = {problem.pads[sortie.pad]};
      time += best_sortie(alone, sortie.first, sortie.last);
      pads_used.insert(sortie.pad);
    }
    EXPECT_NEAR(time, best, 1e-9);
    EXPECT_EQ(split.sorties.front().first, 0U);
    EXPECT_EQ(split.sorties.back().last, 9U);
  }
  EXPECT_GT(split_cases, 5);
  EXPECT_EQ(pads_used.size(), 3U);
}

TEST(SortieSplit, IsEmptyWhenCapturePointIsOutOfReach) {
  SplitProblem problem;
  problem.pads = {{.out = {{1, 20}}, .back = {{1, 20}}}};
  problem.capture_point = {{1, 1}};
  problem.energy_per_sortie = 30;
  problem.capture_points_per_sortie = 10;
  EXPECT_TRUE(split_into_sorties(problem).sorties.empty());
}

}  // namespace
}  // namespace skycap::flight
