#include "missions/batch/benchmark/pattern_comparison.h"

#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::missions::batch {
namespace {

using testing::HasSubstr;

/// Returns a survey that covers `coverage[i]` after `minutes[i]` and 100 m per minute.
Trial trial_of(const std::vector<double>& minutes, const std::vector<double>& coverage,
               bool has_vehicle = true) {
  Trial trial;
  trial.views = coverage.size();
  trial.coverage = {coverage.back(), 2.0 * coverage.back(), {}};
  trial.coverage_after = coverage;
  for (const double minute : minutes) {
    trial.distance_after.push_back(100.0 * minute);
    if (has_vehicle) trial.flight_time_after.push_back(60.0 * minute);
  }
  trial.distance = trial.distance_after.back();
  return trial;
}

TEST(PatternComparison, ComparesEffortAtEqualCoverage) {
  const std::vector<BenchmarkCell> cells{
      {"house", "skycap", {trial_of({1, 2, 3}, {0.2, 0.4, 0.48})}},
      {"house", "facade", {trial_of({1, 2, 4, 6}, {0.1, 0.2, 0.3, 0.4})}},
      {"tower", "rings", {trial_of({1, 2}, {0.1, 0.2})}},  // without a planner
      {"house", "uniform", {trial_of({1}, {0.1})}, 5}};
  const std::vector<PatternComparison> comparisons = compare_with_patterns(cells);
  ASSERT_EQ(comparisons.size(), 1U);
  const PatternComparison& comparison = comparisons.front();
  EXPECT_EQ(comparison.pattern, "facade");
  EXPECT_TRUE(comparison.is_in_minutes);
  EXPECT_DOUBLE_EQ(comparison.planner_effort, 3.0);
  EXPECT_DOUBLE_EQ(comparison.pattern_effort, 6.0);
  EXPECT_DOUBLE_EQ(comparison.pattern_coverage, 0.4);
  EXPECT_DOUBLE_EQ(comparison.pattern_visible.value(), 0.8);
  EXPECT_DOUBLE_EQ(comparison.coverage_at_equal_effort, 0.48);
  EXPECT_DOUBLE_EQ(comparison.equal_coverage, 0.4);
  EXPECT_DOUBLE_EQ(comparison.planner_effort_at_equal_coverage.value(), 2.0);
  EXPECT_DOUBLE_EQ(comparison.pattern_effort_at_equal_coverage.value(), 6.0);
  EXPECT_DOUBLE_EQ(comparison.ratio().value(), 3.0);
}

// If the pattern covers more, both are compared at the planner's coverage.
TEST(PatternComparison, UsesCoverageThatBothReach) {
  const std::vector<BenchmarkCell> cells{
      {"house", "skycap", {trial_of({2, 4}, {0.2, 0.3}), trial_of({2, 6}, {0.25, 0.4})}},
      {"house", "dome", {trial_of({1, 2, 8}, {0.1, 0.3, 0.5})}}};
  const PatternComparison comparison = compare_with_patterns(cells).at(0);
  EXPECT_DOUBLE_EQ(comparison.equal_coverage, 0.3);
  EXPECT_DOUBLE_EQ(comparison.planner_effort_at_equal_coverage.value(), 5.0);  // of 4 and 6
  EXPECT_DOUBLE_EQ(comparison.pattern_effort_at_equal_coverage.value(), 2.0);
  EXPECT_DOUBLE_EQ(comparison.ratio().value(), 0.4);
  EXPECT_DOUBLE_EQ(comparison.coverage_at_equal_effort, 0.35);
}

TEST(PatternComparison, UsesPathLengthWithoutVehicle) {
  const std::vector<BenchmarkCell> cells{{"house", "skycap", {trial_of({1, 2}, {0.2, 0.4}, false)}},
                                         {"house", "nadir", {trial_of({1, 3}, {0.1, 0.4}, false)}}};
  const PatternComparison comparison = compare_with_patterns(cells).at(0);
  EXPECT_FALSE(comparison.is_in_minutes);
  EXPECT_DOUBLE_EQ(comparison.pattern_effort, 300.0);
  EXPECT_DOUBLE_EQ(comparison.ratio().value(), 1.5);
  const std::string report = pattern_markdown(cells);
  EXPECT_THAT(report, HasSubstr("| house | Skycap | Nadir | 80.0 | 200 | 80.0 | 300 |"));
  EXPECT_THAT(report, HasSubstr("| 1.50 |"));
  EXPECT_EQ(pattern_markdown({cells.front()}), "");
}

}  // namespace
}  // namespace skycap::missions::batch
