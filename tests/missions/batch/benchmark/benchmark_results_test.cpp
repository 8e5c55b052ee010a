#include "missions/batch/benchmark/benchmark_results.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "missions/batch/benchmark/benchmark_curves.h"
#include "missions/batch/benchmark/benchmark_report.h"
#include "missions/batch/benchmark/other_results.h"
#include "missions/batch/benchmark/paper_results.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;

/// Returns a survey of three views at 0, 1 and 3 m, after 1, 2 and 4 s.
batch::Trial trial(double a, double b, double c) {
  batch::Trial trial;
  trial.views = 3;
  trial.coverage = {c, c + 0.1, 0.95};
  trial.coverage_after = {a, b, c};
  trial.distance_after = {0.0, 1.0, 3.0};
  trial.planning_time_after = {1.0, 2.0, 4.0};
  trial.distance = 3.0;
  trial.planning_time = 4.0;
  trial.frontiers_resolved = 6;
  return trial;
}

TEST(CoverageCurve, AveragesStepsAtEvenDistances) {
  const std::vector<batch::Trial> trials{trial(0.2, 0.4, 0.8), trial(0.4, 0.4, 0.6)};
  const auto curve =
      batch::coverage_curve(trials, batch::CurveAxis::distance, 7);  // sampled every 0.5 m
  ASSERT_EQ(curve.size(), 7U);
  EXPECT_DOUBLE_EQ(curve[1].x, 0.5);
  EXPECT_DOUBLE_EQ(curve[1].mean, 0.3);
  EXPECT_DOUBLE_EQ(curve[1].deviation, std::sqrt(0.02));
  EXPECT_DOUBLE_EQ(curve[2].mean, 0.4);  // the second view is at 1 m
  EXPECT_DOUBLE_EQ(curve[5].mean, 0.4);
  EXPECT_DOUBLE_EQ(curve[6].mean, 0.7);
}

TEST(CoverageCurve, SpacesTimesLogarithmically) {
  const auto curve =
      batch::coverage_curve({trial(0.2, 0.4, 0.8)}, batch::CurveAxis::planning_time, 3);
  ASSERT_EQ(curve.size(), 3U);
  EXPECT_DOUBLE_EQ(curve[0].x, 1.0);
  EXPECT_DOUBLE_EQ(curve[1].x, 2.0);
  EXPECT_DOUBLE_EQ(curve[2].x, 4.0);
  EXPECT_DOUBLE_EQ(curve[2].mean, 0.8);
}

TEST(CoverageCurve, KeepsFinalCoverageOfFinishedTrials) {
  batch::Trial longer = trial(0.2, 0.4, 0.6);
  longer.coverage_after.push_back(1.0);
  longer.distance_after.push_back(9.0);
  longer.planning_time_after.push_back(5.0);
  const auto curve =
      batch::coverage_curve({trial(0.2, 0.4, 0.6), longer}, batch::CurveAxis::views, 4);
  EXPECT_DOUBLE_EQ(curve.back().x, 4.0);
  EXPECT_DOUBLE_EQ(curve.back().mean, 0.8);
}

TEST(CoverageCurve, RequiresFlightsForFlightTimeAxis) {
  batch::Trial flight_trial = trial(0.2, 0.4, 0.8);
  flight_trial.flight_time_after = {60.0, 90.0, 180.0};
  const auto curve =
      batch::coverage_curve({flight_trial, flight_trial}, batch::CurveAxis::flight_time, 5);
  ASSERT_EQ(curve.size(), 5U);
  EXPECT_DOUBLE_EQ(curve[0].x, 60.0);
  EXPECT_DOUBLE_EQ(curve[1].x, 90.0);
  EXPECT_DOUBLE_EQ(curve[1].mean, 0.4);
  EXPECT_DOUBLE_EQ(curve[3].mean, 0.4);
  EXPECT_DOUBLE_EQ(curve[4].mean, 0.8);
  EXPECT_TRUE(
      batch::coverage_curve({flight_trial, trial(0.2, 0.4, 0.8)}, batch::CurveAxis::flight_time, 5)
          .empty());
}

TEST(CoverageCurve, IsEmptyWithoutTrials) {
  EXPECT_TRUE(batch::coverage_curve({}, batch::CurveAxis::views, 4).empty());
}

TEST(TargetFigures, CountViewsAndDistancesUntilTargetIsObserved) {
  batch::Trial a = trial(0.1, 0.2, 0.3);
  a.targets = {{1, 0.4}, {2, 0.7}, {1, 1.6}, {40, 99.0}};
  const batch::TargetFigures figures = batch::target_figures({a});
  EXPECT_EQ(figures.targets, 4U);
  EXPECT_DOUBLE_EQ(figures.share_by_views[0], 0.5);
  EXPECT_DOUBLE_EQ(figures.share_by_views[1], 0.25);
  EXPECT_DOUBLE_EQ(figures.share_by_views.back(), 0.25);  // bin of ten or more views
  EXPECT_DOUBLE_EQ(figures.share_by_distance[0], 0.25);   // bin below 0.5 m
  EXPECT_DOUBLE_EQ(figures.share_by_distance[1], 0.5);
  EXPECT_DOUBLE_EQ(figures.share_by_distance.back(), 0.75);
}

TEST(ReachFigures, UseFirstViewThatReachesCoverage) {
  const auto reach = batch::reach_figures({trial(0.2, 0.4, 0.8), trial(0.4, 0.5, 0.6)}, 0.4);
  ASSERT_TRUE(reach);
  EXPECT_EQ(reach->reached, 2U);
  EXPECT_DOUBLE_EQ(reach->views.mean, 1.5);
  EXPECT_DOUBLE_EQ(reach->distance.mean, 0.5);
  EXPECT_DOUBLE_EQ(reach->planning_time.mean, 1.5);
}

TEST(ReachFigures, IgnoreTrialsThatEndBelowCoverage) {
  const std::vector<batch::Trial> trials{trial(0.2, 0.4, 0.8), trial(0.4, 0.5, 0.6)};
  const auto reach = batch::reach_figures(trials, 0.7);
  ASSERT_TRUE(reach);
  EXPECT_EQ(reach->reached, 1U);
  EXPECT_EQ(reach->views.mean, 3.0);
  EXPECT_FALSE(batch::reach_figures(trials, 0.9));
}

TEST(ViewFigures, AverageOverTrials) {
  const batch::ViewFigures figures =
      batch::view_figures({trial(0.1, 0.2, 0.6), trial(0.1, 0.2, 0.9)});
  EXPECT_DOUBLE_EQ(figures.frontiers.mean, 2.0);
  EXPECT_DOUBLE_EQ(figures.coverage.mean, 0.25);
}

// Table 1 of the paper.
TEST(PaperResults, MatchPublishedTables) {
  const auto dragon = batch::paper_result("dragon", "pc");
  ASSERT_TRUE(dragon);
  EXPECT_EQ(dragon->views, 130);
  EXPECT_EQ(dragon->coverage, 0.972);
  EXPECT_EQ(dragon->planning_time, 306);
  EXPECT_EQ(dragon->distance, 59.2);
  EXPECT_EQ(batch::paper_result("radcliffe_camera", "see")->distance, 1302);
  EXPECT_EQ(batch::paper_result("teapot", "uv")->distance,
            batch::paper_result("teapot", "oa")->distance);
  EXPECT_FALSE(batch::paper_result("teapot", "skycap"));
  EXPECT_FALSE(batch::paper_result("vase", "see"));
  EXPECT_EQ(batch::paper_view_result("see++")->frontiers, 6.51);
  EXPECT_FALSE(batch::paper_view_result("oa"));
  EXPECT_TRUE(batch::is_standard_model("bunny"));
  EXPECT_FALSE(batch::is_standard_model("radcliffe_camera"));
}

std::vector<batch::BenchmarkCell> two_cells() {
  batch::Trial see = trial(0.2, 0.4, 0.8);
  see.targets = {{1, 0.4}};
  return {{"teapot", "see", {see, trial(0.4, 0.5, 0.6)}}, {"teapot", "oa", {trial(0, 0, 0.5)}}};
}

TEST(BenchmarkReport, WritesRatiosToPaperResults) {
  const auto json = nlohmann::json::parse(batch::results_json(two_cells()));
  const auto& see = json["results"][0];
  EXPECT_EQ(see["views"]["mean"], 3.0);
  EXPECT_EQ(see["views"]["paper"], 60.0);
  EXPECT_DOUBLE_EQ(see["views"]["ratio_to_paper"], 0.05);
  EXPECT_DOUBLE_EQ(see["coverage"]["mean"], 0.7);
  EXPECT_DOUBLE_EQ(see["coverage_visible"]["mean"], 0.8);
  // a single trial has no confidence interval.
  EXPECT_TRUE(json["results"][1]["views"]["half_width_95"].is_null());
}

TEST(BenchmarkReport, WritesBothTablesAsMarkdown) {
  const std::string text = batch::report_markdown(two_cells());
  EXPECT_THAT(text, HasSubstr("| SEE | 3.0 (60.0) | 70.0 (98.1) | 4 (4.13) | 3.0 (42.8) |"));
  EXPECT_THAT(text, HasSubstr("| OA | 3.0 (105.0) |"));
  EXPECT_THAT(text, HasSubstr("| SEE | 2.00 | 4.49 | 23.33 | 1.39 |"));
  EXPECT_THAT(text, HasSubstr("| SEE | 1 | 100.0 | 100.0 |"));
}

TEST(BenchmarkReport, ReportsEffortToReachCoverageOfSee) {
  std::vector<batch::BenchmarkCell> cells = two_cells();
  cells[1].trials = {trial(0.1, 0.75, 0.9), trial(0.1, 0.2, 0.3)};
  const std::string text = batch::report_markdown(cells);
  // SEE reaches 70% after 3 views and 3 m. One of two surveys with OA reaches it at view 2, after 1
  // m.
  EXPECT_THAT(text,
              HasSubstr("| SEE here, 70.0 | OA | 1 of 2 | 2.0, 0.67× | 2, 0.50× | 1.0, 0.33× |"));
  EXPECT_THAT(text, HasSubstr("| the paper's SEE++, 97.1 | OA | 0 of 2 | - | - | - |"));
  const auto json = nlohmann::json::parse(batch::results_json(cells));
  EXPECT_EQ(json["results"][1]["until_coverage_of"]["see"]["views"]["mean"], 2.0);
  EXPECT_EQ(json["results"][1]["until_coverage_of"]["paper"]["trials"], 0);
}

TEST(BenchmarkReport, WritesCsvLineForEachCellAndTrial) {
  const std::string table = batch::table_1_csv(two_cells());
  EXPECT_EQ(std::ranges::count(table, '\n'), 3);
  EXPECT_THAT(table, HasSubstr("\nteapot,oa,1,3,0,,105,"));
  const std::string trials = batch::all_trials_csv(two_cells());
  EXPECT_EQ(std::ranges::count(trials, '\n'), 4);
  EXPECT_THAT(trials, HasSubstr("mission,planner,seed,"));
  EXPECT_THAT(trials, HasSubstr("\nteapot,oa,0,complete,3,"));
}

TEST(TrialJson, ReadsBackSameTrial) {
  batch::Trial before = trial(0.1 + 0.2, 1.0 / 3.0, 0.7);
  before.seed = 18'000'000'000'000'000'001ULL;
  before.stop_reason = survey::StopReason::view_limit;
  before.points = 7;
  before.targets = {{2, 1.0 / 7.0}};
  before.coverage.attainable_coverage = {};
  const batch::Trial after = batch::parse_trial(batch::trial_json(before));
  EXPECT_EQ(batch::trial_json(after), batch::trial_json(before));
  EXPECT_EQ(after.seed, before.seed);
  EXPECT_EQ(after.coverage_after, before.coverage_after);
  EXPECT_EQ(after.stop_reason, before.stop_reason);
  EXPECT_FALSE(after.coverage.attainable_coverage);
}

TEST(TrialJson, RejectsInvalidTrials) {
  const auto error_message = [](const std::string& text) {
    return testing_support::thrown_message([&] { batch::parse_trial(text); });
  };
  for (const char* text : {"", "[1, 2]"}) {
    EXPECT_THAT(error_message(text), HasSubstr("is not a trial: ")) << text;
  }
  // Each field is first missing, then of another type.
  const std::string whole = batch::trial_json(trial(0.5, 0.25, 0.7));
  const auto fields = nlohmann::json::parse(whole);
  ASSERT_GE(fields.size(), 15U);
  for (const auto& [name, value] : fields.items()) {
    if (name == "stop_reason" || name == "flown_s") continue;  // other error message; not read
    nlohmann::json corrupted = fields;
    corrupted.erase(name);
    // Trials of version 0.1 have no values of these measures.
    const bool is_optional = name.starts_with("grid_coverage") || name == "chamfer_distance_m";
    EXPECT_THAT(error_message(corrupted.dump()), HasSubstr(is_optional ? "" : "'" + name + "'"));
    corrupted[name] = "x";
    EXPECT_THAT(error_message(corrupted.dump()), HasSubstr("is not a trial: ")) << name;
  }
}

TEST(Report, SaysHowManySurveysWereCutShort) {
  batch::Trial cut = trial(0.2, 0.4, 0.8);
  cut.stop_reason = survey::StopReason::view_limit;
  const std::vector<batch::BenchmarkCell> cells{{"bunny", "see++", {cut, trial(0.2, 0.4, 0.8)}},
                                                {"bunny", "see", {trial(0.2, 0.4, 0.8)}},
                                                {"bunny", "oa", {cut}}};
  const std::string report = batch::report_markdown(cells);
  EXPECT_THAT(report, HasSubstr("\nSEE++: 1 of 2 surveys ended at limits.max_views. Ratios to the "
                                "paper compare unfinished surveys.\n"));
}

std::string other_complaint(const testing_support::TemporaryFolder& folder,
                            const std::string& json) {
  const std::filesystem::path file = folder.file("mine.json", json);
  return testing_support::thrown_message([&] { batch::read_other_results(file); });
}

TEST(OtherResults, AreTrialsLikeThoseOfThisProgram) {
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path file =
      folder.file("mine.json",
                  R"([{"planner": "mine", "mission": "vase", "more": 1, "trials": [
        {"seed": 7, "coverage_after": [0.25, 0.5], "distance_after_m": [0, 3],
         "planning_time_after_s": [0.1, 0.3], "coverage_visible": 0.625},
        {"coverage_after": [0.75], "distance_after_m": [0], "stop_reason": "view_limit"}]}])");
  const std::vector<batch::BenchmarkCell> cells = batch::read_other_results(file);
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0].planner, "mine");
  ASSERT_EQ(cells[0].trials.size(), 2U);
  const batch::Trial& first = cells[0].trials[0];
  EXPECT_EQ(first.seed, 7U);
  EXPECT_EQ(first.views, 2U);
  EXPECT_EQ(first.coverage.all, 0.5);
  EXPECT_EQ(first.coverage.visible, 0.625);
  EXPECT_EQ(first.distance, 3.0);
  EXPECT_EQ(first.planning_time, 0.3);
  EXPECT_EQ(cells[0].trials[1].stop_reason, survey::StopReason::view_limit);
  const nlohmann::json results = nlohmann::json::parse(batch::results_json(cells));
  EXPECT_EQ(results.at("results")[0].at("title"), "mine");
  EXPECT_EQ(results.at("results")[0].at("coverage").at("mean"), 0.625);
}

TEST(OtherResults, NameWhatIsWrong) {
  const testing_support::TemporaryFolder folder;
  const std::string head = R"({"planner": "mine", "mission": "vase", "trials": [)";
  EXPECT_THAT(other_complaint(folder, "{"), HasSubstr("mine.json: is not valid JSON"));
  EXPECT_THAT(other_complaint(folder, "{}"), HasSubstr("mine.json: missing mission"));
  EXPECT_THAT(other_complaint(folder, head + "]}"), HasSubstr("missing trials"));
  EXPECT_THAT(other_complaint(folder, head + "{}]}"), HasSubstr("trial 1: missing coverage_after"));
  const auto trial = [&](const std::string& fields) {
    return other_complaint(folder, head + "{" + fields + "}]}");
  };
  EXPECT_THAT(trial(R"("coverage_after": [0.5, 1.5], "distance_after_m": [0, 1])"),
              HasSubstr("trial 1: coverage_after must be a number from 0 to 1"));
  EXPECT_THAT(trial(R"("coverage_after": [0.5, 0.6], "distance_after_m": [0])"),
              HasSubstr("distance_after_m has 1 numbers; expected 2"));
  EXPECT_THAT(trial(R"("coverage_after": [0.5, 0.6], "distance_after_m": [2, 1])"),
              HasSubstr("distance_after_m must not decrease"));
  EXPECT_THAT(trial(R"("coverage_after": [0.5], "distance_after_m": [0], "stop_reason": "tired")"),
              HasSubstr("trial 1: stop_reason: "));
}

TEST(Curves, AreLinesForSpreadsheetsAndADrawing) {
  const std::vector<batch::BenchmarkCell> cells{
      {"vase", "see++", {trial(0.2, 0.4, 0.8), trial(0.4, 0.4, 0.6)}},
      {"vase", "a<b", {trial(0.5, 0.5, 0.9)}}};
  const std::string csv = batch::curves_csv(cells);
  EXPECT_THAT(
      csv, testing::StartsWith("mission,planner,axis,x,coverage,standard_deviation\nvase,see++,"));
  EXPECT_THAT(csv, HasSubstr("\nvase,see++,views,2.0101010101010104,0.4,0\n"));
  EXPECT_THAT(csv, HasSubstr("vase,a<b,distance_m,3,0.9,0\n"));
  EXPECT_THAT(csv, HasSubstr(",planning_time_s,"));
  EXPECT_THAT(batch::curves_csv(cells, batch::Times::left_out),
              testing::Not(HasSubstr("planning_time_s")));
  const std::string svg = batch::curves_svg(cells);
  // Three charts with two curves each, and two lines of the legend. There are no flights.
  std::size_t curves = 0;
  for (std::size_t at = svg.find("class=\"curve\""); at != std::string::npos;
       at = svg.find("class=\"curve\"", at + 1)) {
    ++curves;
  }
  EXPECT_EQ(curves, 8U);
  EXPECT_THAT(svg, HasSubstr("a&lt;b</text>"));
  EXPECT_THAT(svg, testing::Not(HasSubstr("flight time")));
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace skycap::missions
