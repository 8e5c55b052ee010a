#include "missions/package/replan/observation_sum.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace skycap::missions::package {
namespace {

using survey::surfel::GainField;
using survey::surfel::Observation;

std::vector<GainField::Target> targets_weighing(const std::vector<float>& weights) {
  std::vector<GainField::Target> targets;
  for (const float weight : weights) {
    targets.push_back({Eigen::Vector3f::Zero(), Eigen::Vector3f::UnitZ(), weight});
  }
  return targets;
}

// Computed by hand: 1 - sum of w exp(-H) / sum of w.
TEST(ObservationSum, MatchesCoverageModel) {
  ObservationSum sum(targets_weighing({1.0F, 3.0F}));
  EXPECT_EQ(sum.covered(), 0.0);
  sum.add(observation_strengths(std::vector<Observation>{{0, 1.0F}, {1, 0.5F}}));
  sum.add(observation_strengths(std::vector<Observation>{{1, 1.5F}}));
  const double missing = (std::exp(-1.0) + 3.0 * std::exp(-2.0)) / 4.0;
  // Weights have 20 bits and fractions have 24 bits.
  EXPECT_NEAR(sum.covered(), 1.0 - missing, 1e-6);
  EXPECT_NEAR(static_cast<double>(sum.missing(1)) / static_cast<double>(sum.missing(0)),
              3.0 * std::exp(-1.0), 1e-5);
}

// Hazards are rounded to 1/256. The error is at most half of that, with random sign.
TEST(ObservationSum, LimitsErrorOfRoundedHazards) {
  ObservationSum sum(targets_weighing({2.0F}));
  double hazard = 0.0;
  for (int i = 1; i <= 10; ++i) {
    const float single_hazard = 0.0731F * static_cast<float>(i);
    sum.add(observation_strengths(std::vector<Observation>{{0, single_hazard}}));
    hazard += double{single_hazard};
    EXPECT_NEAR(sum.covered(), 1.0 - std::exp(-hazard), std::exp(-hazard) * i / 512.0 + 1e-6);
  }
}

// A search adds and removes views ten thousand times. Removed views must leave no residue.
TEST(ObservationSum, ForgetsRemovedViewsExactly) {
  std::mt19937_64 random(5);
  std::vector<float> weights;
  for (int i = 0; i < 500; ++i) weights.push_back(0.1F + static_cast<float>(random() % 1000));
  const auto targets = targets_weighing(weights);
  std::vector<std::vector<ObservationStrength>> views(12);
  for (auto& view : views) {
    std::vector<Observation> observations;
    for (std::uint32_t t = 0; t < 500; ++t) {
      if (random() % 3 == 0)
        observations.push_back({t, static_cast<float>(random() % 7000) / 1000.0F});
    }
    view = observation_strengths(observations);
  }
  ObservationSum sum(targets);
  std::vector<bool> is_in(views.size(), false);
  for (int i = 0; i < 5000; ++i) {
    const std::size_t v = random() % views.size();
    if (is_in[v]) {
      sum.remove(views[v]);
    } else {
      sum.add(views[v]);
    }
    is_in[v] = !is_in[v];
  }
  ObservationSum fresh(targets);
  for (std::size_t v = views.size(); v-- > 0;) {
    if (is_in[v]) fresh.add(views[v]);
  }
  EXPECT_EQ(sum.covered(), fresh.covered());
  for (std::uint32_t t = 0; t < 500; ++t) ASSERT_EQ(sum.missing(t), fresh.missing(t)) << t;
}

}  // namespace
}  // namespace skycap::missions::package
