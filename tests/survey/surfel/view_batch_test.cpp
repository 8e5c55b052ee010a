#include "survey/surfel/view_batch.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using surfel::BatchView;
using surfel::Stop;

struct Problem {
  std::vector<BatchView> views;
  std::vector<float> weights;
};

/// Returns random views in a box, each of which observes some of 30 targets.
Problem random_problem(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> coordinate(-5.0, 5.0);
  std::uniform_real_distribution<float> share(0.1F, 0.9F);
  Problem problem{std::vector<BatchView>(12), std::vector<float>(30)};
  for (float& weight : problem.weights) weight = share(random);
  for (BatchView& view : problem.views) {
    for (int axis = 0; axis < 3; ++axis) view.position[axis] = coordinate(random);
    for (std::uint32_t target = 0; target < problem.weights.size(); ++target) {
      if (random() % 3 == 0) view.visible_targets.push_back({target, share(random)});
    }
  }
  return problem;
}

/// Returns the area of the targets that these views cover together. Probabilities of misses
/// multiply.
double covered(const Problem& problem, const std::vector<std::size_t>& views) {
  double sum = 0.0;
  for (std::uint32_t target = 0; target < problem.weights.size(); ++target) {
    double missed = 1.0;
    for (const std::size_t i : views) {
      for (const surfel::VisibleTarget& s : problem.views[i].visible_targets) {
        if (s.target == target) missed *= 1.0 - s.covered_share;
      }
    }
    sum += problem.weights[target] * (1.0 - missed);
  }
  return sum;
}

// Brute-force reference: each pick is computed again from the joint coverage of all picks.
TEST(PickBatch, MatchesBruteForceGreedyCover) {
  const Vector3d position(1, 2, 3);
  const surfel::BatchSettings settings{.size = 6, .view_price = 3.0, .min_fraction = 0.2};
  std::size_t full = 0, cut_short = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Problem problem = random_problem(seed);
    std::vector<std::size_t> expected;
    double first_gain = 0.0;
    while (expected.size() < settings.size) {
      std::size_t best = 0;
      double best_score = -1.0, best_gain = 0.0;
      for (std::size_t i = 0; i < problem.views.size(); ++i) {
        double path_length = (problem.views[i].position - position).norm();
        for (const std::size_t j : expected) {
          path_length =
              std::min(path_length, (problem.views[i].position - problem.views[j].position).norm());
        }
        std::vector<std::size_t> with = expected;
        with.push_back(i);
        const double gain = covered(problem, with) - covered(problem, expected);
        if (gain / (settings.view_price + path_length) <= best_score) continue;
        best = i;
        best_score = gain / (settings.view_price + path_length);
        best_gain = gain;
      }
      if (expected.empty()) first_gain = best_gain;
      if (best_gain < settings.min_fraction * first_gain) break;
      expected.push_back(best);
    }
    std::vector<std::size_t> picked;
    for (const Stop& s : surfel::pick_batch(problem.views, problem.weights, position, settings)) {
      picked.push_back(s.view);
    }
    EXPECT_EQ(picked, expected) << seed;
    (picked.size() == settings.size ? full : cut_short) += 1;
  }
  EXPECT_GT(full, 0U);
  EXPECT_GT(cut_short, 0U);
}

TEST(PickBatch, HasGainsThatSumToBatchCoverage) {
  const Problem problem = random_problem(7);
  double sum = 0.0;
  std::vector<std::size_t> picked;
  for (const Stop& s : surfel::pick_batch(problem.views, problem.weights, Vector3d::Zero(), {})) {
    sum += s.gain;
    picked.push_back(s.view);
  }
  EXPECT_NEAR(sum, covered(problem, picked), 1e-5 * sum);  // single against double precision
}

TEST(PickBatch, IsEmptyWithoutVisibleTargets) {
  EXPECT_THAT(surfel::pick_batch({}, {}, Vector3d::Zero(), {}), testing::IsEmpty());
  const std::vector<BatchView> blind = {{Vector3d::Zero(), {}}};
  EXPECT_THAT(surfel::pick_batch(blind, {1.0F}, Vector3d::Zero(), {}), testing::IsEmpty());
}

/// Returns the minimum cost of a tour through `left`, by recursion over the next stop.
double min_cost(const Problem& problem, const std::vector<Stop>& batch,
                std::vector<std::size_t> left, const Vector3d& at, double length, double impatience,
                double total_gain) {
  if (left.empty()) return length;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < left.size(); ++k) {
    const Stop& next = batch[left[k]];
    std::vector<std::size_t> rest = left;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    const Vector3d& coordinate = problem.views[next.view].position;
    const double reached = length + (coordinate - at).norm();
    best = std::min(
        best, impatience * reached * next.gain / total_gain +
                  min_cost(problem, batch, rest, coordinate, reached, impatience, total_gain));
  }
  return best;
}

TEST(FirstStop, StartsTourOfMinCost) {
  const Vector3d position(4, -4, 0);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Problem problem = random_problem(seed);
    const std::vector<Stop> batch =
        surfel::pick_batch(problem.views, problem.weights, position, {.min_fraction = 0.0});
    double total_gain = 0.0;
    for (const Stop& s : batch) total_gain += s.gain;
    const auto cost_from = [&](std::vector<std::size_t> left, const Vector3d& at, double length) {
      return min_cost(problem, batch, std::move(left), at, length, 0.15, total_gain);
    };
    const std::vector<std::size_t> all = {0, 1, 2, 3, 4};
    ASSERT_EQ(batch.size(), all.size());
    const std::size_t first = first_stop(problem.views, batch, position, 0.15);
    std::vector<std::size_t> rest = all;
    std::erase(rest, first);
    const Vector3d& coordinate = problem.views[batch[first].view].position;
    const double path_length = (coordinate - position).norm();
    const double cost = 0.15 * path_length * batch[first].gain / total_gain +
                        cost_from(rest, coordinate, path_length);
    EXPECT_NEAR(cost, cost_from(all, position, 0.0), 1e-9) << seed;
  }
}

// Stops at 2 and -3 on a line, starting at 0: the nearer one is first, unless nearly all gain is at
// -3.
TEST(FirstStop, WeighsEarlyGainAgainstPathLength) {
  const std::vector<BatchView> views = {{{2, 0, 0}, {}}, {{-3, 0, 0}, {}}};
  const auto first = [&](double gain_at_2, double gain_at_3, double impatience) {
    return first_stop(views, std::vector<Stop>{{0, gain_at_2}, {1, gain_at_3}}, Vector3d::Zero(),
                      impatience);
  };
  EXPECT_EQ(first(1.0, 1.0, 0.15), 0U);  // 7 m against 8 m
  EXPECT_EQ(first(0.0, 1.0, 0.15), 0U);  // 7 m + 0.15 x 7 m against 8 m + 0.15 x 3 m
  EXPECT_EQ(first(0.0, 1.0, 0.3), 1U);   // 7 m + 0.3 x 7 m against 8 m + 0.3 x 3 m
}

}  // namespace
}  // namespace skycap::survey
