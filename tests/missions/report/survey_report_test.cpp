#include "missions/report/survey_report.h"

#include <numbers>
#include <stop_token>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/report/page_parts.h"
#include "missions/report/point_figures.h"
#include "missions/report/verdict.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++found;
  }
  return found;
}

/// Returns the data of the HTML report, as JSON.parse() in a browser reads them.
Json extract_data(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t at = page.find(begin) + begin.size();
  return Json::parse(page.substr(at, page.find("</script>", at) - at));
}

/// A survey and its results.
struct Planned {
  explicit Planned(const std::string& mission, const std::vector<std::string>& more = {},
                   std::stop_token stop = {}) {
    std::vector<std::string> arguments = {"plan", folder.write("m.yaml", mission), "--quiet",
                                          "--out", folder / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run = tests::run_skycap(arguments, false, std::move(stop));
  }
  std::string page() const { return tests::read_content(folder.path() / "out" / "report.html"); }

  tests::TestFolder folder;
  tests::ProgramRun run;
};

TEST(SurveyReport, IsSameFromPlanAndReportCommands) {
  const Planned survey(tests::quick_mission(), {"--planner", "skycap"});
  const std::string page = survey.page();
  ASSERT_FALSE(page.empty());
  const auto run =
      tests::run_skycap({"report", survey.folder / "out", "--out", survey.folder / "again.html"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(tests::read_content(survey.folder / "again.html") == page);
}

TEST(SurveyReport, ShowsOnlyFiguresOfSummary) {
  const Planned survey(tests::quick_mission(), {"--planner", "skycap"});
  const Json data = extract_data(survey.page());
  EXPECT_EQ(data["summary"], Json::parse(tests::read_content(survey.folder / "out/summary.json")));
  EXPECT_EQ(data["clouds"]["measured"]["of"], data["summary"]["points"]);
  for (const Json& light : data["verdict"]["lights"]) {
    std::string path = "/" + light["figure"].get<std::string>();
    std::ranges::replace(path, '.', '/');
    const Json::json_pointer pointer(path);
    if (path.ends_with("/length")) continue;
    EXPECT_EQ(light["value"], data["summary"][pointer]) << path;
  }
}

// The table sums to the missing fraction of the surface, for planners with and without an estimate.
TEST(SurveyReport, HasHolesThatSumToMissingFraction) {
  for (const char* planner : {"skycap", "see++"}) {
    const Planned survey(tests::quick_mission(), {"--planner", planner});
    const Json summary = extract_data(survey.page())["summary"];
    const Json& surface = summary["surface"];
    double missing = surface["smaller"]["area_m2"].get<double>() + surface["rest_m2"].get<double>();
    for (const Json& hole : surface["holes"]) missing += hole["area_m2"].get<double>();
    const bool has_estimate = std::string(planner) == "skycap";
    EXPECT_EQ(surface["known_by"], has_estimate ? "planner" : "simulator");
    const double coverage =
        (has_estimate ? summary["estimate"]["estimated_coverage"] : summary["coverage"])
            .get<double>();
    EXPECT_NEAR(missing / surface["area_m2"].get<double>(), 1.0 - coverage, 1e-5) << planner;
  }
}

TEST(SurveyReport, IsOmittedOnRequest) {
  const Planned survey(tests::quick_mission(), {"--no-report"});
  EXPECT_TRUE(std::filesystem::exists(survey.folder.path() / "out" / "summary.json"));
  EXPECT_FALSE(std::filesystem::exists(survey.folder.path() / "out" / "report.html"));
}

// By default an interrupted survey has no report, because the user waits for the program to end.
TEST(SurveyReport, IsWrittenForInterruptedSurveyOnRequest) {
  std::stop_source stop;
  stop.request_stop();
  const Planned survey(tests::quick_mission(), {}, stop.get_token());
  EXPECT_EQ(survey.run.exit_code, 1);
  EXPECT_TRUE(std::filesystem::exists(survey.folder.path() / "out" / "summary.json"));
  EXPECT_FALSE(std::filesystem::exists(survey.folder.path() / "out" / "report.html"));
  EXPECT_EQ(tests::run_skycap({"report", survey.folder / "out"}).exit_code, 0);
  const Json data = extract_data(survey.page());
  EXPECT_EQ(data["verdict"]["light"], "red");
  EXPECT_EQ(data["summary"]["stop_reason"], "interrupted");
}

// Camera keys are not part of such a survey and would conflict with the lidar.
TEST(SurveyReport, IsWrittenForLidarSurvey) {
  const Planned survey(
      "scene: {model: 'builtin:teapot', longest_side: 10.0}\n"
      "sensor: {lidar: velodyne_vlp16}\n"
      "planner: {name: skycap, density: 20, resolution_radius: 0.5, view_distance: 12}\n"
      "evaluation: {coverage_distance: 0.3, samples: 1000, visible_directions: 30,\n"
      "             attainable_views: 0}\n",
      {"--max-views", "1"});
  const std::string page = survey.page();
  ASSERT_FALSE(page.empty()) << survey.run.err;
  const Json settings = extract_data(page)["summary"]["settings"];
  EXPECT_EQ(settings["sensor.lidar"], "velodyne_vlp16");
  EXPECT_FALSE(settings.contains("sensor.width"));
}

// A mission name cannot end a script or create an element, neither in the title nor in the data.
// The name of a mission file cannot contain '/', but a summary may come from anywhere.
TEST(SurveyReport, EscapesMissionNames) {
  const Planned survey(tests::quick_mission());
  const std::string plain = survey.page(), file = survey.folder / "out/summary.json";
  Json summary = Json::parse(tests::read_content(file));
  summary["mission"] =
      "</script><img src=x onerror=alert(1)><!--\n\"'\u2028" + std::string(10'000, 'x');
  std::ofstream(file) << summary;
  ASSERT_EQ(tests::run_skycap({"report", survey.folder / "out"}).exit_code, 0);
  const std::string page = survey.page();
  for (const char* mark : {"<script", "</script", "<img", "<!--"}) {
    EXPECT_EQ(count(page, mark), count(plain, mark)) << mark;
  }
  EXPECT_EQ(extract_data(page)["title"], summary["mission"]);
}

// Only Skycap's own scripts may run, and nothing may be fetched.
TEST(SurveyReport, HasStrictPolicyAndNoExternalLinks) {
  const std::string page = Planned(tests::quick_mission()).page();
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  const std::string policy = page.substr(page.find("content=\"default"), 1000);
  EXPECT_THAT(policy.substr(0, policy.find("\">")), Not(HasSubstr("unsafe")));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
  EXPECT_THAT(std::string(page_script()), Not(HasSubstr("fetch(")));
  EXPECT_THAT(std::string(page_script()), Not(HasSubstr("innerHTML")));
}

TEST(SurveyReport, IsWrittenWithoutCloud) {
  const Planned survey(tests::quick_mission());
  std::filesystem::remove(survey.folder.path() / "out" / "cloud.ply");
  const auto run = tests::run_skycap({"report", survey.folder / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(extract_data(survey.page())["clouds"]["measured"]["points"], 0);
}

// Trials and a survey in the same folder have separate reports.
TEST(TrialsReport, IsWrittenSeparatelyFromSurveyReport) {
  const Planned survey(tests::quick_mission(), {"--max-views", "3"});
  const auto trials =
      tests::run_skycap({"plan", survey.folder / "m.yaml", "--trials", "2", "--max-views", "3",
                         "--quiet", "--out", survey.folder / "out"});
  ASSERT_EQ(trials.exit_code, 0) << trials.err;
  const auto file = survey.folder.path() / "out" / "trials.html";
  const std::string page = tests::read_content(file);
  const Json data = extract_data(page);
  EXPECT_EQ(data["kind"], "trials");
  EXPECT_EQ(data["summary"], Json::parse(tests::read_content(survey.folder / "out/trials.json")));
  EXPECT_EQ(data["summary"]["each_trial"].size(), 2U);
  std::filesystem::remove(file);
  std::filesystem::remove(survey.folder.path() / "out" / "report.html");
  const auto run = tests::run_skycap({"report", survey.folder / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(tests::read_content(file) == page);
  EXPECT_EQ(extract_data(survey.page())["kind"], "survey");
  // With one output file, the report would be ambiguous.
  const auto one = tests::run_skycap({"report", survey.folder / "out", "--out", "x.html"});
  EXPECT_EQ(one.exit_code, 2);
  EXPECT_THAT(one.err, HasSubstr("contains several reports"));
}

TEST(ResultReports, RejectInvalidResults) {
  const tests::TestFolder folder;
  for (const char* name : {"trials.json", "results.json"}) {
    for (const char* text : {"", "[]", "{}", "{\"results\": 3, \"trials\": []}"}) {
      folder.write(name, text);
      const auto run = tests::run_skycap({"report", folder.path().string()});
      EXPECT_EQ(run.exit_code, 2) << text;
      EXPECT_THAT(run.err, HasSubstr(name)) << text;
    }
    std::filesystem::remove(folder.path() / name);
  }
}

TEST(SurveyReport, RejectsInvalidSummaries) {
  const tests::TestFolder folder;
  EXPECT_EQ(tests::run_skycap({"report", folder.path().string()}).exit_code, 2);
  for (const char* text : {"", "[]", "{}", "{\"settings\": {}, \"per_view\": 3}"}) {
    folder.write("summary.json", text);
    const auto run = tests::run_skycap({"report", folder.path().string()});
    EXPECT_EQ(run.exit_code, 2) << text;
    EXPECT_THAT(run.err, HasSubstr("summary.json")) << text;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "report.html"));
  }
}

TEST(View, WritesHtmlReportOfCloudAndPrintsItsPath) {
  const tests::TestFolder folder;
  const auto run = tests::run_skycap(
      {"view", folder.write("c.xyz", "0 0 0\n1 0 0\n0 1 0\n"), "--out", folder / "c.html"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("c.html"));
  EXPECT_EQ(extract_data(tests::read_content(folder / "c.html"))["clouds"]["measured"]["points"],
            3);
}

TEST(View, ShowsMissionBeforeSurvey) {
  const tests::TestFolder folder;
  const std::string mission = tests::quick_mission(
      "site: {no_fly: [{corners: [[5, 5], [9, 5], [9, 9]], floor: 0, ceiling: 30}]}\n");
  const auto run =
      tests::run_skycap({"view", folder.write("m.yaml", mission), "--out", folder / "m.html"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json data = extract_data(tests::read_content(folder / "m.html"));
  EXPECT_EQ(data["kind"], "mission");
  EXPECT_EQ(data["scene"]["volumes"][0]["role"], "no_fly");
  EXPECT_EQ(data["scene"]["volumes"][0]["top"], 30.0);
  EXPECT_EQ(data["clouds"]["model"]["of"], 3000);
}

// Observed perpendicularly, at 45 degrees, from behind, and unobserved.
TEST(PointFigures, ComputeIncidenceAngleToSensor) {
  geometry::AttributedCloud cloud;
  cloud.positions.assign(4, Eigen::Vector3f::Zero());
  cloud.normals.assign(4, Eigen::Vector3f::UnitZ());
  cloud.views = {0, 1, 2, 9};
  const std::vector<geometry::View> views = {
      {{0, 0, 3}, {0, 0, -1}}, {{3, 0, 3.1}, {-1, 0, -1}}, {{0, 0, -2}, {0, 0, 1}}};
  EXPECT_THAT(incidence_steps(cloud, views), ElementsAre(0, 4, 17, no_incidence));
  EXPECT_THAT(ranges(cloud, views)[0], 3.0F);
  EXPECT_TRUE(std::isnan(ranges(cloud, views)[3]));
}

// The mean of four points has half the error of one. For rays at 45 degrees (the middle of that
// step), the error along the normal is cos(45) times the noise. Unobserved points are ignored.
TEST(PointFigures, ReduceSurfaceErrorByNeighbours) {
  geometry::AttributedCloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5F, 0.5F, 0}, {9, 9, 9}};
  const std::vector<std::uint16_t> steps = {4, 4, 4, 4, no_incidence, 4};
  const auto errors = surface_errors(cloud, steps, {.head_on = 0.02, .is_along_ray = false}, 1.5);
  ASSERT_EQ(errors.size(), 6U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_FLOAT_EQ(errors[i], 0.01F);
  EXPECT_FLOAT_EQ(errors[5], 0.02F);
  const auto along = surface_errors(cloud, steps, {.head_on = 0.02, .is_along_ray = true}, 1.5);
  EXPECT_FLOAT_EQ(along[0], static_cast<float>(0.01 / std::numbers::sqrt2));
  EXPECT_TRUE(surface_errors(cloud, steps, {}, 1.5).empty());
}

TEST(PointFigures, CountEachValueOnceInHistogram) {
  const std::vector<float> values = {-1.0F, 0.0F, 0.9F, 1.0F, 3.0F, 4.0F, NAN};
  EXPECT_THAT(histogram(values, 0.0, 4.0, 4), ElementsAre(3, 1, 0, 2));
}

TEST(Verdict, AssignsLightsByThresholds) {
  const auto light = [](double coverage) {
    return verdict({{"complete", true}, {"coverage_visible", coverage}})["lights"][0]["light"];
  };
  EXPECT_EQ(light(0.95), "green");
  EXPECT_EQ(light(0.9499), "amber");
  EXPECT_EQ(light(0.8499), "red");
  EXPECT_EQ(verdict({{"stop_reason", "view_limit"}})["light"], "amber");
  EXPECT_EQ(verdict({{"unseen_box_surface", 0.7}})["lights"][0]["light"], "amber");
  EXPECT_EQ(verdict({{"unseen_box_surface", 0.2}})["lights"][0]["light"], "green");
  const Json route = {{"min_clearance_m", 1.9}, {"sorties", Json::array()}, {"skipped_views", {1}}};
  const Json lights =
      verdict({{"flight", {{"clearance_m", {{"total", 2.0}}}, {"route", route}}}})["lights"];
  EXPECT_EQ(lights[0]["light"], "red");    // below the requested value
  EXPECT_EQ(lights[1]["light"], "amber");  // a view is skipped
}

}  // namespace
}  // namespace skycap::missions::report
