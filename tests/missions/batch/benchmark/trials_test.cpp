#include "missions/batch/benchmark/trials.h"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/batch/benchmark/benchmark_report.h"
#include "missions/config/resolve.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;

// Student's t for 4 degrees of freedom is 2.776 at 97.5% (standard tables).
TEST(Statistic, MatchesHandComputedExample) {
  const batch::Statistic s = batch::statistic({2, 4, 4, 6, 9});
  EXPECT_DOUBLE_EQ(s.mean, 5.0);
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt(7.0));
  EXPECT_NEAR(s.half_width_95, 2.776 * std::sqrt(7.0 / 5.0), 1e-3);
}

TEST(Statistic, HasInfiniteIntervalForOneNumber) {
  const batch::Statistic s = batch::statistic({3});
  EXPECT_EQ(s.mean, 3.0);
  EXPECT_EQ(s.deviation, 0.0);
  EXPECT_TRUE(std::isinf(s.half_width_95));
}

std::vector<batch::Trial> two_trials() {
  batch::Trial a, b;
  a.seed = 1, a.views = 2, a.distance = 3, a.coverage = {0.8, 0.9, 0.99};
  a.coverage_after = {0.5, 0.8}, a.distance_after = {0, 3};
  a.planning_time_after = {0.1, 0.2};
  a.flight_length = 7, a.flight_time_after = {5, 12.5};
  b.seed = 2, b.views = 4, b.distance = 5, b.coverage = {1.0, {}, {}};
  b.stop_reason = survey::StopReason::view_limit;
  b.coverage_after = {0.3, 0.6, 0.9, 1.0}, b.distance_after = {0, 1, 2, 5};
  b.planning_time_after = {0.1, 0.2, 0.3, 0.4};
  return {a, b};
}

config::MissionSetup mission_called(const std::string& name, const std::string& more = "") {
  return config::parse_mission("name: " + name +
                                   "\nscene: {model: 'builtin:teapot'}\n"
                                   "evaluation: {coverage_distance: 0.005}\n" +
                                   more,
                               "m.yaml");
}

TEST(Trials, KeepsFinalValuesOfFinishedSurveysInCurves) {
  const auto json =
      nlohmann::json::parse(batch::trials_json(mission_called("vase"), two_trials(), 2, 1));
  EXPECT_EQ(json["trials"], 2);
  EXPECT_EQ(json["trials_complete"], 1);
  EXPECT_EQ(json["views"]["mean"], 3.0);
  const std::vector<double> coverage = json["mean_after_view"]["coverage"];
  ASSERT_EQ(coverage.size(), 4U);
  EXPECT_DOUBLE_EQ(coverage[1], 0.7);
  EXPECT_DOUBLE_EQ(coverage[3], 0.9);  // (0.8 + 1.0) / 2
  EXPECT_DOUBLE_EQ(json["mean_after_view"]["distance_m"][2], 2.5);
}

TEST(Trials, ReportsPaperResults) {
  const config::MissionSetup mission = mission_called("vase", "paper: {views: 22.3}\n");
  const auto json = nlohmann::json::parse(batch::trials_json(mission, two_trials(), 2, 1));
  EXPECT_EQ(json["views"]["paper"], 22.3);
  EXPECT_FALSE(json["coverage"].contains("paper"));
  const std::string table = batch::trials_table(mission, two_trials());
  EXPECT_THAT(table, HasSubstr("vase: 2 trials, 1 complete"));
  EXPECT_THAT(table, HasSubstr("22.3"));
}

// Table 1 is used if the mission is one of its models and does not set paper values itself.
TEST(Trials, UsesPaperRowOfPlanner) {
  const config::MissionSetup mission =
      mission_called("bunny", "planner: {name: see}\npaper: {coverage: 0.5}\n");
  const auto json = nlohmann::json::parse(batch::trials_json(mission, two_trials(), 2, 1));
  EXPECT_EQ(json["views"]["paper"], 75.3);
  EXPECT_EQ(json["coverage"]["paper"], 0.5);
  EXPECT_EQ(json["distance_m"]["paper"], 56.3);
  EXPECT_FALSE(json["coverage_visible"].contains("paper"));
}

TEST(Trials, WritesNamesOfAnyLengthInTable) {
  const config::MissionSetup mission = mission_called(std::string(1000, 'v'));
  EXPECT_THAT(batch::trials_table(mission, two_trials()),
              testing::StartsWith(mission.name + ": 2 trials, 1 complete\n"));
}

TEST(Trials, WritesCsvLineForEachTrial) {
  EXPECT_EQ(
      batch::trials_csv(two_trials()),
      "seed,stop_reason,views,coverage,coverage_visible,attainable_coverage,distance_m,points,"
      "flown_m,flown_s,planning_time_s\n"
      "1,complete,2,0.8,0.9,0.99,3,0,7,12.5,0\n"
      "2,view_limit,4,1,,,5,0,,,0\n");
}

TEST(Trials, ReadsBackWrittenTrials) {
  for (const batch::Trial& trial : two_trials()) {
    const batch::Trial again = batch::parse_trial(batch::trial_json(trial));
    EXPECT_EQ(again.flight_length, trial.flight_length);
    EXPECT_EQ(again.flight_time_after, trial.flight_time_after);
    EXPECT_EQ(batch::trials_csv({again}), batch::trials_csv({trial}));
  }
}

}  // namespace
}  // namespace skycap::missions
