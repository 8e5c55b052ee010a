#include "missions/batch/benchmark/uniform_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/batch/benchmark/benchmark_report.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing::Not;

batch::Trial trial(std::uint64_t seed, std::size_t views, double coverage, double distance) {
  batch::Trial trial;
  trial.seed = seed;
  trial.views = views;
  trial.coverage.all = coverage;
  trial.distance = distance;
  trial.coverage_after.assign(views, coverage);
  trial.distance_after.assign(views, distance);
  trial.planning_time_after.assign(views, 0.0);
  return trial;
}

/// Four seeds, whose starts change coverage and distance by the same amount for all planners.
batch::BenchmarkCell make_cell(const std::string& planner, std::size_t views, double coverage,
                               double distance, std::optional<std::size_t> set_views = {}) {
  batch::BenchmarkCell cell{"m", planner, {}, set_views};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const double start = 0.01 * static_cast<double>(seed);
    const double own = 1e-5 * static_cast<double>(seed * views % 3);  // a little scatter
    cell.trials.push_back(trial(seed, views, coverage + start + own, distance + 100.0 * start));
  }
  return cell;
}

std::vector<batch::BenchmarkCell> sets() {
  return {make_cell("uniform", 5, 0.60, 8.0, 5), make_cell("uniform", 10, 0.80, 14.0, 10),
          make_cell("uniform", 20, 0.90, 22.0, 20)};
}

batch::UniformComparison compare(const batch::BenchmarkCell& cell) {
  std::vector<batch::BenchmarkCell> cells = sets();
  cells.push_back(cell);
  const auto comparisons = batch::compare_with_uniform(cells);
  EXPECT_EQ(comparisons.size(), 1U);
  return comparisons.front();
}

// The scatter of the starts is 1.3% of coverage and 1.3 m, more than the differences: they count
// because they are paired by seed.
TEST(UniformComparison, PairsDifferencesBySeed) {
  const auto comparison = compare(make_cell("see++", 10, 0.805, 13.5));
  EXPECT_EQ(comparison.same_views, 10U);
  ASSERT_TRUE(comparison.coverage_difference && comparison.distance_difference);
  EXPECT_NEAR(comparison.coverage_difference->difference.mean, 0.005, 1e-4);
  EXPECT_EQ(comparison.coverage_difference->outcome, batch::Outcome::better);
  EXPECT_NEAR(comparison.distance_difference->difference.mean, -0.5, 1e-12);
  EXPECT_TRUE(comparison.beats_uniform());
  EXPECT_EQ(comparison.verdict(), "beats uniform");
}

TEST(UniformComparison, StatesPlannersThatDoNotBeatUniform) {
  const auto worse = compare(make_cell("see++", 10, 0.79, 15.0));
  EXPECT_FALSE(worse.beats_uniform());
  EXPECT_EQ(worse.verdict(), "does not beat uniform");
  EXPECT_EQ(compare(make_cell("see++", 10, 0.80, 14.0)).verdict(), "does not beat uniform");
  EXPECT_EQ(compare(make_cell("see++", 10, 0.82, 15.0)).verdict(), "more coverage, longer path");
  EXPECT_EQ(compare(make_cell("see++", 10, 0.78, 13.0)).verdict(), "shorter path, less coverage");
}

TEST(UniformComparison, StatesNoDifferenceForSingleTrial) {
  batch::BenchmarkCell cell = make_cell("see++", 10, 0.9, 10.0);
  cell.trials.resize(1);
  EXPECT_EQ(compare(cell).verdict(), "does not beat uniform");
}

TEST(UniformComparison, FindsLeastNumberOfViewsThatReachesCoverage) {
  const auto comparison = compare(make_cell("see++", 10, 0.805, 13.5));
  EXPECT_EQ(comparison.reaching_views, 20U);
  EXPECT_NEAR(comparison.reaching_distance->mean, 22.0 + 2.5, 1e-12);
  const auto beyond = compare(make_cell("see++", 10, 0.99, 13.5));
  EXPECT_FALSE(beyond.reaching_views);
  EXPECT_EQ(beyond.max_tested_views, 20U);
}

TEST(UniformComparison, BisectsNumberOfViews) {
  std::vector<batch::BenchmarkCell> cells = sets();
  const auto next = [&](double coverage) {
    return batch::next_set_views(make_cell("see++", 10, coverage, 1.0), cells);
  };
  EXPECT_EQ(next(0.85), 15U);
  EXPECT_EQ(next(0.70), 7U);
  EXPECT_EQ(next(0.50), 2U);
  EXPECT_EQ(next(0.95), std::nullopt);
  cells.push_back(make_cell("uniform", 9, 0.70, 13.0, 9));
  EXPECT_EQ(next(0.75), std::nullopt);  // 9 views are too few, 10 are enough
}

TEST(UniformComparison, IsFirstTableOfReport) {
  std::vector<batch::BenchmarkCell> cells = sets();
  cells.push_back(make_cell("skycap", 10, 0.79, 15.0));
  const std::string report = batch::report_markdown(cells);
  const std::size_t comparison = report.find("## Comparison with surveys without planning");
  ASSERT_NE(comparison, std::string::npos);
  EXPECT_LT(comparison, report.find("## Table 1"));
  EXPECT_THAT(report, HasSubstr("granted the centroid"));
  EXPECT_THAT(report, HasSubstr("| Skycap | m | 10.0 ± 0 | "));
  EXPECT_THAT(report, HasSubstr("| does not beat uniform | 10 | "));
  // Sets have no rows in the tables of planners.
  EXPECT_THAT(report.substr(report.find("## Table 1")), Not(HasSubstr("Uniform")));
  const auto json = nlohmann::json::parse(batch::results_json(cells));
  EXPECT_EQ(json["results"].size(), 1U);
  EXPECT_EQ(json["uniform_comparison"][0]["beats_uniform"], false);
  EXPECT_EQ(json["fixed_views"].size(), 3U);
  EXPECT_THAT(batch::all_trials_csv(cells), HasSubstr("m,uniform_20,4,"));
}

TEST(UniformComparison, IsAbsentWithoutFixedViews) {
  const std::vector<batch::BenchmarkCell> cells{make_cell("skycap", 10, 0.79, 15.0)};
  EXPECT_EQ(batch::uniform_markdown(cells), "");
  EXPECT_FALSE(nlohmann::json::parse(batch::results_json(cells)).contains("uniform_comparison"));
}

}  // namespace
}  // namespace skycap::missions
