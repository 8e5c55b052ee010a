// End-to-end tests of skycap benchmark.
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stop_token>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/batch/benchmark/methods.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using tests::ProgramRun;
using tests::quick_mission;
using tests::read_content;
using tests::run_skycap;
using Json = nlohmann::json;

class BenchmarkCommand : public testing::Test {
 protected:
  ProgramRun run(const std::string& planners, const std::vector<std::string>& more = {},
                 std::stop_token stop = {}) const {
    std::vector<std::string> arguments{"benchmark", mission_, "--planners", planners,
                                       "--trials",  "2",      "--out",      folder_ / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_skycap(arguments, false, std::move(stop));
  }
  std::filesystem::path item(const std::string& planner, int seed) const {
    return folder_.path() / "out" / "items" / "quick" / planner /
           ("seed_" + std::to_string(seed) + ".json");
  }
  Json trial(const std::string& planner, int seed) const {
    return Json::parse(read_content(item(planner, seed)))["trial"];
  }
  /// Returns trials.csv without its last column, the planning time.
  std::string trials_without_times() const {
    std::istringstream lines(read_content(folder_.path() / "out" / "trials.csv"));
    std::string text;
    for (std::string line; std::getline(lines, line);) {
      text += line.substr(0, line.rfind(',')) + "\n";
    }
    return text;
  }

  tests::TestFolder folder_;
  std::string mission_ = folder_.write("quick.yaml", quick_mission());
};

TEST_F(BenchmarkCommand, WritesTablesForAllPlannersOfPaper) {
  const ProgramRun result = run("all", {"--max-views", "5"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");  // no progress output without a terminal
  const Json json = Json::parse(read_content(folder_.path() / "out" / "results.json"));
  EXPECT_EQ(json["results"].size(), 9U);
  for (const Json& cell : json["results"]) EXPECT_EQ(cell["trials"], 2) << cell["planner"];
  for (const char* title : {"SEE++", "SEE", "RSV", "RSE", "OA", "UV", "PC", "AF", "AE"}) {
    EXPECT_THAT(result.out, HasSubstr(std::string("| ") + title + " |"));
  }
}

TEST_F(BenchmarkCommand, StartsAllPlannersFromSameView) {
  ASSERT_EQ(run("see,see++,oa,skycap", {"--max-views", "3"}).exit_code, 0);
  for (const int seed : {1, 2}) {
    // With equal pose and noise, the first points and their coverage are equal.
    const Json first = trial("see", seed)["coverage_after"][0];
    for (const char* planner : {"see++", "oa", "skycap"}) {
      EXPECT_EQ(trial(planner, seed)["coverage_after"][0], first) << planner;
    }
  }
  EXPECT_NE(trial("see", 1)["coverage_after"][0], trial("see", 2)["coverage_after"][0]);
}

TEST_F(BenchmarkCommand, WritesSameTablesAfterInterruption) {
  ASSERT_EQ(run("see++,oa", {"--max-views", "6"}).exit_code, 0);
  const std::string whole = trials_without_times();
  std::filesystem::remove(item("oa", 1));
  std::ofstream(item("see++", 2)) << read_content(item("see++", 2)).substr(0, 50);  // truncated
  ASSERT_EQ(run("see++,oa", {"--max-views", "6"}).exit_code, 0);
  EXPECT_EQ(trials_without_times(), whole);
}

TEST_F(BenchmarkCommand, SkipsFinishedRuns) {
  ASSERT_EQ(run("oa", {"--max-views", "4"}).exit_code, 0);
  Json stored = Json::parse(read_content(item("oa", 1)));
  stored["trial"]["points"] = 123456789;
  std::ofstream(item("oa", 1)) << stored;
  ASSERT_EQ(run("oa", {"--max-views", "4"}).exit_code, 0);
  EXPECT_EQ(trial("oa", 1)["points"], 123456789);
  EXPECT_THAT(trials_without_times(), HasSubstr("123456789"));
}

TEST_F(BenchmarkCommand, RepeatsRunsOfOtherSettings) {
  ASSERT_EQ(run("oa", {"--max-views", "4"}).exit_code, 0);
  ASSERT_EQ(run("oa", {"--max-views", "5"}).exit_code, 0);
  EXPECT_EQ(trial("oa", 1)["views"], 5);
}

TEST_F(BenchmarkCommand, WritesSameTablesForAnyThreadCount) {
  ASSERT_EQ(run("see,oa,pc", {"--max-views", "6", "--threads", "1"}).exit_code, 0);
  const std::string alone = trials_without_times();
  std::filesystem::remove_all(folder_.path() / "out");
  ASSERT_EQ(run("see,oa,pc", {"--max-views", "6", "--threads", "3"}).exit_code, 0);
  EXPECT_EQ(trials_without_times(), alone);
}

// Paper, section IV-B.
TEST_F(BenchmarkCommand, LimitsVolumetricSurveysToMaxViewsOfSee) {
  ASSERT_EQ(run("see,oa").exit_code, 0);
  const int max =
      std::max(trial("see", 1)["views"].get<int>(), trial("see", 2)["views"].get<int>());
  EXPECT_EQ(trial("oa", 1)["views"], max);
  EXPECT_EQ(trial("oa", 2)["views"], max);
}

TEST_F(BenchmarkCommand, ReportsFinishedRunsWhenInterrupted) {
  ASSERT_EQ(run("oa", {"--max-views", "3"}).exit_code, 0);
  std::stop_source stop;
  stop.request_stop();
  const ProgramRun result = run("oa,pc", {"--max-views", "3"}, stop.get_token());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("| OA | 2 |"));
  EXPECT_FALSE(std::filesystem::exists(item("pc", 1)));
}

TEST_F(BenchmarkCommand, RegeneratesHtmlReport) {
  const ProgramRun result = run("see,see++", {"--max-views", "4"});
  EXPECT_EQ(result.err, "");
  const std::string page = read_content(folder_.path() / "out" / "benchmark.html");
  EXPECT_THAT(page, HasSubstr("\"kind\":\"comparison\""));
  std::filesystem::remove(folder_.path() / "out" / "benchmark.html");
  const ProgramRun again = run_skycap({"report", folder_ / "out"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(read_content(folder_.path() / "out" / "benchmark.html") == page);
  ASSERT_EQ(run("see,see++", {"--max-views", "4", "--no-report"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out" / "benchmark.html"));
}

// Each number of views has its own set; every planner is compared at its own number of views.
TEST_F(BenchmarkCommand, ComparesPlannersWithFixedViews) {
  const ProgramRun result = run("see++,uniform,random", {"--max-views", "9", "--set-views", "3,6"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("## Comparison with surveys without planning"));
  EXPECT_EQ(trial("uniform_6", 1)["views"], 6);
  EXPECT_EQ(trial("random_3", 2)["views"], 3);
  const Json json = Json::parse(read_content(folder_.path() / "out" / "results.json"));
  ASSERT_EQ(json["uniform_comparison"].size(), 1U);
  const Json& see = json["uniform_comparison"][0];
  EXPECT_EQ(see["planner"], "see++");
  EXPECT_THAT(result.out, HasSubstr("## Measures of the GenNBV protocol"));
  for (const Json& set : json["fixed_views"]) {
    EXPECT_GT(set["grid_coverage"]["mean"], 0.3);
    EXPECT_LE(set["grid_coverage"]["mean"], set["grid_coverage_visible"]["mean"]);
    EXPECT_LE(set["coverage_auc"]["30"]["mean"], set["coverage"]["mean"]);
  }
  EXPECT_FALSE(see["coverage_difference"].is_null());
  const std::string same = "uniform_" + std::to_string(see["same_views"].get<int>());
  EXPECT_EQ(trial(same, 1)["views"], see["same_views"]);
  // The common start: the same first scan as that of the planner.
  EXPECT_EQ(trial(same, 1)["coverage_after"][0], trial("see++", 1)["coverage_after"][0]);
  EXPECT_THAT(read_content(folder_.path() / "out" / "benchmark.html"),
              HasSubstr("uniform_comparison"));
}

// The example in the documentation.
TEST_F(BenchmarkCommand, RunsPlannerInPython) {
  const std::string file = std::string(SKYCAP_SOURCE_DIR) + "/examples/own_planner/random_views.py";
  const ProgramRun result = run("see++," + file, {"--max-views", "5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("| random_views |"));
  EXPECT_EQ(trial("random_views", 1)["views"], 5);
  EXPECT_EQ(trial("random_views", 1)["coverage_after"][0], trial("see++", 1)["coverage_after"][0]);
  EXPECT_GT(trial("random_views", 1)["planning_time_s"], 0.0);
  EXPECT_THAT(read_content(folder_.path() / "out" / "benchmark.html"), HasSubstr("random_views"));
  const ProgramRun missing = run("see++,no_such.py");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("cannot open the planner no_such.py"));
}

TEST_F(BenchmarkCommand, RejectsUnknownPlanners) {
  const ProgramRun result = run("see,frontier");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err,
              HasSubstr("unknown planner 'frontier'; expected all or names from see++"));
}

TEST_F(BenchmarkCommand, GeneratesSceneOfFamilyForEachSeed) {
  const ProgramRun result =
      run("see", {"--scenes", "fences,statue", "--max-views", "1", "--set",
                  "evaluation.samples=1000", "--set", "scene.longest_side=1", "--no-report"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json manifest = Json::parse(read_content(folder_.path() / "out" / "manifest.json"));
  ASSERT_EQ(manifest["entries"].size(), 2U);
  EXPECT_EQ(manifest["entries"][0]["mission"], "fences");
  EXPECT_EQ(manifest["entries"][1]["mission"], "statue");
  // The visible surfaces of two scenes of a family differ, independent of the start pose.
  for (const char* family : {"fences", "statue"}) {
    const auto items = folder_.path() / "out" / "items" / family / "see";
    const Json one = Json::parse(read_content(items / "seed_1.json"));
    const Json two = Json::parse(read_content(items / "seed_2.json"));
    EXPECT_NE(one["fingerprint"], two["fingerprint"]) << family;
  }
}

TEST_F(BenchmarkCommand, RejectsUnknownFamilies) {
  const ProgramRun result = run("see", {"--scenes", "garage,castle"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--scenes: unknown family 'castle'; expected all or bridge"));
}

TEST_F(BenchmarkCommand, RejectsMissionsOfSameName) {
  std::filesystem::create_directory(folder_.path() / "other");
  const std::string other = folder_.write("other/quick.yaml", quick_mission());
  const ProgramRun result = run("oa", {other});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("have the same name"));
}

TEST(BenchmarkMethods, HaveUniqueNames) {
  std::set<std::string> names;
  for (const batch::Method& method : batch::methods()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_EQ(batch::find_method(method.name), &method);
  }
  EXPECT_EQ(batch::find_method("frontier"), nullptr);
}

}  // namespace
}  // namespace skycap::missions
