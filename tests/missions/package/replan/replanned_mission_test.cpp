// Replanned mission from the survey to its files, by the program.

#include "missions/package/replanned_mission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/config/resolve.h"
#include "missions/package/package.h"
#include "tests/missions/results_in.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using tests::flight_mission;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

/// Returns packages of a survey with a replanned mission and of the same survey with its own views.
const TestFolder& packages() {
  static const TestFolder folder;
  static const bool are_made = [] {
    const std::string mission = folder.write("m.yaml", flight_mission());
    const auto replanned = run_skycap({"plan", mission, "--out", folder / "anew", "--threads", "1",
                                       "--set", "flight.views=replanned"});
    EXPECT_EQ(replanned.exit_code, 0) << replanned.err;
    EXPECT_THAT(replanned.out, HasSubstr("  coverage  "));
    const auto survey = run_skycap({"plan", mission, "--out", folder / "survey"});
    EXPECT_EQ(survey.exit_code, 0) << survey.err;
    const auto fastest = run_skycap({"plan", mission, "--out", folder / "fastest", "--threads", "1",
                                     "--set", "flight.views=fastest"});
    EXPECT_EQ(fastest.exit_code, 0) << fastest.err;
    EXPECT_THAT(fastest.out, HasSubstr("  written   "));
    return true;
  }();
  EXPECT_TRUE(are_made);
  return folder;
}

json read_summary(const std::string& package) {
  return json::parse(read_content(packages() / (package + "/summary.json")));
}

TEST(ReplannedMission, IsFasterWithoutLessPredictedCoverage) {
  const json flight = read_summary("anew").at("flight");
  const json& replanned = flight.at("replanned");
  ASSERT_TRUE(replanned.at("is_flown").get<bool>());
  const auto figure = [&](const char* whose, const char* name) {
    return replanned.at(whose).at(name).get<double>();
  };
  EXPECT_LT(figure("replanned", "duration_s"), figure("survey", "duration_s"));
  EXPECT_GE(figure("replanned", "predicted_coverage"),
            figure("survey", "predicted_coverage") - 5e-4);
  EXPECT_EQ(flight.at("route").at("duration_s"), replanned.at("replanned").at("duration_s"));
  EXPECT_EQ(flight.at("route").at("length_m"), replanned.at("replanned").at("length_m"));
  EXPECT_EQ(flight.at("route").at("stations"), replanned.at("stations").size());
  EXPECT_TRUE(flight.at("route").at("skipped_views").empty());
  std::size_t segments = 0;
  for (const json& sortie : flight.at("route").at("sorties")) {
    for (const json& leg : sortie.at("legs")) segments += leg.at("points").size() - 1;
  }
  EXPECT_EQ(replanned.at("replanned").at("pieces").get<std::size_t>(), segments);
}

// The reference for the comparison is the survey's own mission.
TEST(ReplannedMission, IsComparedWithSurveyMission) {
  const json own = read_summary("survey").at("flight");
  EXPECT_FALSE(own.contains("replanned"));
  const json compared = read_summary("anew").at("flight").at("replanned").at("survey");
  EXPECT_EQ(compared.at("duration_s"), own.at("route").at("duration_s"));
  EXPECT_EQ(compared.at("length_m"), own.at("route").at("length_m"));
  EXPECT_EQ(compared.at("views"), own.at("route").at("stations"));
}

/// Duration of the mission as its own file flies it.
double file_duration(const json& summary, const std::string& name) {
  for (const json& file : summary.at("flight").at("files")) {
    if (file.at("name") == name) return file.at("duration_s").get<double>();
  }
  ADD_FAILURE() << name;
  return 0.0;
}

TEST(FastestMission, IsFastestThatKeepsPredictedReflight) {
  const json summary = read_summary("fastest"), choice = summary.at("flight").at("replanned");
  EXPECT_EQ(summary.at("settings").at("flight.views"), "fastest");
  const auto figure = [&](const char* whose, const char* name) {
    return choice.at(whose).at(name).get<double>();
  };
  const bool keeps =
      figure("replanned", "predicted_reflight") >= figure("survey", "predicted_reflight") - 0.003;
  const bool is_faster = figure("replanned", "duration_s") < figure("survey", "duration_s");
  const bool is_replanned = choice.at("is_flown").get<bool>();
  EXPECT_EQ(is_replanned, keeps && is_faster);
  EXPECT_FALSE(choice.at("reason").get<std::string>().empty());
  EXPECT_NEAR(file_duration(summary, "mission.plan"),
              figure(is_replanned ? "replanned" : "survey", "duration_s"), 0.01);
  EXPECT_LE(file_duration(summary, "mission.plan"),
            file_duration(read_summary("survey"), "mission.plan"));
}

// The prediction uses the measured points only, the re-flight the ground truth. The tolerance for
// the coverage of the survey's views is 0.005; the scatter of a re-flight of few samples is larger.
TEST(FastestMission, KeepsCoverageInSimulatedReflight) {
  const auto covered = [](const std::string& package) {
    return read_summary(package)
        .at("flight")
        .at("written")
        .at(0)
        .at("coverage_visible")
        .get<double>();
  };
  EXPECT_GT(covered("fastest"), covered("survey") - 0.02);
}

TEST(FastestMission, IsSameForAnyThreadCount) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "fastest threads",
                               "--threads", "2", "--set", "flight.views=fastest"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::vector<std::string> timed = {"summary.json", "report.html"};
  EXPECT_EQ(tests::results_in(folder / "fastest", timed),
            tests::results_in(folder / "fastest threads", timed));
}

TEST(FastestMission, ExportsSameFilesAgain) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"export", folder / "fastest", "--format", "plan", "--format", "csv",
                               "--out", folder / "fastest again"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* file : {"mission.plan", "mission.csv"}) {
    EXPECT_EQ(read_content(folder / ("fastest again/" + std::string(file))),
              read_content(folder / ("fastest/" + std::string(file))));
  }
}

TEST(FastestMission, IsSurveyMissionIfThereIsNoChoice) {
  const auto views = [](std::vector<config::KeyOverride> keys) {
    keys.push_back({"--set", "flight.views", "fastest"});
    return config::parse_mission(flight_mission(), "m.yaml", keys).flight().views;
  };
  EXPECT_EQ(flight::FlightOptions().views, flight::MissionViews::fastest);
  EXPECT_EQ(views({}), flight::MissionViews::fastest);
  EXPECT_EQ(views({{"--set", "flight.vehicle", "none"}}), flight::MissionViews::survey);
  EXPECT_EQ(views({{"--set", "planner.name", "see++"}}), flight::MissionViews::survey);
  EXPECT_EQ(views({{"--set", "planner.name", "rings"}}), flight::MissionViews::survey);
  EXPECT_EQ(views({{"--set", "flight.order", "survey"}}), flight::MissionViews::survey);
  EXPECT_EQ(views({{"--set", "flight.vehicles", "[generic, generic]"}}),
            flight::MissionViews::survey);
}

TEST(ReplannedMission, KeepsSurveyFilesUnchanged) {
  const TestFolder& folder = packages();
  for (const char* name : {"views.csv", "cloud.ply", "coverage.ply", "free_space.bin"}) {
    EXPECT_EQ(read_content(folder / ("anew/" + std::string(name))),
              read_content(folder / ("survey/" + std::string(name))))
        << name;
  }
}

// The coverage model predicts fractions of the measured surface. The evaluation measures fractions
// of the visible surface, which are similar for this teapot. The tolerance of 0.1 exceeds the
// scatter of both.
TEST(ReplannedMission, ReachesSurveyCoverageInSimulatedReflight) {
  const json summary = read_summary("anew");
  const double again =
      summary.at("flight").at("replanned").at("reflight").at("coverage_visible").get<double>();
  EXPECT_GT(again, summary.at("coverage_visible").get<double>() - 0.1);
  EXPECT_LE(again, 1.0);
}

// En-route frames have observed surface that the few views have not. The mission must cover it.
TEST(ReplannedMission, CoversSurfaceSeenByEnRouteFrames) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "moving", "--set",
                               "flight.views=replanned", "--set", "sensor.capture=moving"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json replanned = read_summary("moving").at("flight").at("replanned");
  ASSERT_TRUE(replanned.at("is_flown").get<bool>());
  EXPECT_GT(replanned.at("replanned").at("predicted_coverage").get<double>(),
            replanned.at("survey").at("predicted_coverage").get<double>() + 0.01);
  EXPECT_GT(replanned.at("reflight").at("coverage_visible_unthinned").get<double>(),
            replanned.at("survey_reflight").at("coverage_visible_unthinned").get<double>() - 0.005);
}

TEST(ReplannedMission, IsSameForAnyThreadCount) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "threads", "--threads",
                               "4", "--set", "flight.views=replanned"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::vector<std::string> timed = {"summary.json", "report.html"};
  EXPECT_EQ(tests::results_in(folder / "anew", timed),
            tests::results_in(folder / "threads", timed));
}

// Checks each leg in each file against the ground truth.
TEST(ReplannedMission, KeepsClearanceFromGroundTruthInAllFiles) {
  const TestFolder& folder = packages();
  for (const char* extension : {"plan", "waypoints", "kml", "geojson", "csv"}) {
    const auto check = run_skycap({"check", folder / "m.yaml", "--route",
                                   folder / ("anew/mission." + std::string(extension))});
    EXPECT_EQ(check.exit_code, 0) << extension << check.out << check.err;
    EXPECT_THAT(check.out, HasSubstr(": verified, 0 of "));
  }
}

// Fly-through capture is faster than stop-and-capture, all captures are in the trajectory, and it
// is verified.
TEST(ReplannedMission, CapturesViewsInFlyThrough) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "passing", "--threads",
                               "1", "--set", "flight.views=replanned", "--set",
                               "flight.style=fly-through", "--set", "sensor.exposure=0.0005"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("  passing   "));
  const json stopping = read_summary("anew").at("flight"),
             passing = read_summary("passing").at("flight");
  const auto& sorties = passing.at("route").at("sorties");
  ASSERT_EQ(sorties.size(), 1U);
  const json fly_through = sorties[0].at("passage");
  ASSERT_FALSE(fly_through.is_null());
  EXPECT_LT(fly_through.at("duration_s").get<double>(), sorties[0].at("duration_s").get<double>());
  EXPECT_LT(passing.at("replanned").at("replanned").at("duration_s").get<double>(),
            stopping.at("replanned").at("replanned").at("duration_s").get<double>());
  EXPECT_GE(fly_through.at("clearance_m").get<double>(),
            passing.at("clearance_m").at("total").get<double>());
  const std::string csv = read_content(folder / "passing/mission.csv");
  std::size_t captures = 0;
  for (std::size_t at = csv.find(",1\n"); at != std::string::npos; at = csv.find(",1\n", at + 1)) {
    ++captures;
  }
  EXPECT_EQ(captures, fly_through.at("views").size());
  EXPECT_EQ(captures, passing.at("route").at("stations").get<std::size_t>());
  for (const char* name : {"passing/mission.csv", "passing/mission.kml", "passing/mission.plan"}) {
    const auto check = run_skycap({"check", folder / "m.yaml", "--route", folder / name});
    EXPECT_EQ(check.exit_code, 0) << name << check.out << check.err;
  }
  const auto exported = run_skycap(
      {"export", folder / "passing", "--format", "csv", "--out", folder / "passing again"});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_EQ(read_content(folder / "passing again/mission.csv"), csv);
}

TEST(ReplannedMission, ReportsWhyFlyThroughIsUnavailable) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "blurred", "--set",
                               "flight.style=fly-through", "--set", "sensor.exposure=1", "--set",
                               "limits.max_views=2"});
  EXPECT_THAT(run.out, HasSubstr("  passing   none: ")) << run.err;
  EXPECT_THAT(run.out, HasSubstr("shorten sensor.exposure"));
  const auto resting = run_skycap({"check", folder / "m.yaml", "--set", "flight.style=fly-through",
                                   "--set", "sensor.settle=1"});
  EXPECT_EQ(resting.exit_code, 2);
  EXPECT_THAT(resting.err,
              HasSubstr("flight.style: fly-through conflicts with a sensor that must be at rest"));
}

TEST(ReplannedMission, ExportsSameFilesAgain) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"export", folder / "anew", "--format", "plan", "--format", "csv",
                               "--out", folder / "again"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* file : {"mission.plan", "mission.csv"}) {
    EXPECT_EQ(read_content(folder / ("again/" + std::string(file))),
              read_content(folder / ("anew/" + std::string(file))));
  }
  const auto fly_test_run = run_skycap({"fly-test", folder / "anew", "--flights", "2", "--returns",
                                        "20", "--out", folder / "flown"});
  EXPECT_EQ(fly_test_run.exit_code, 0) << fly_test_run.out << fly_test_run.err;
}

// On request, the export contains the survey's own mission.
TEST(ReplannedMission, ExportsSurveyMissionOnRequest) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"export", folder / "anew", "--format", "csv", "--set",
                               "flight.views=survey", "--out", folder / "back"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_content(folder / "back/mission.csv"), read_content(folder / "survey/mission.csv"));
}

TEST(ReplannedMission, IsRejectedForSurveyWithoutReplannedViews) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"export", folder / "survey", "--format", "csv", "--set",
                               "flight.views=replanned", "--out", folder / "refused"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("summary.json: contains no replanned views; plan the mission "
                                 "again, or set flight.views=survey"));
  EXPECT_FALSE(std::filesystem::exists(folder / "refused/mission.csv"));
}

TEST(ReplannedMission, RejectsWaypointsOutOfRange) {
  json summary = read_summary("anew");
  summary["flight"]["replanned"]["stations"][1]["way"][0][2] = 1e300;
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { package::parse_package_summary(summary.dump(), "summary.json"); }),
              HasSubstr("summary.json: flight.replanned.stations[1].way"));
}

TEST(ReplannedMission, RequiresSkycapPlanner) {
  const auto error_message = [](const std::string& key, const std::string& value) {
    return testing_support::thrown_message([&] {
      config::parse_mission(flight_mission(), "m.yaml",
                            {{"--set", "flight.views", "anew"}, {"--set", key, value}});
    });
  };
  EXPECT_THAT(error_message("planner.name", "see++"),
              HasSubstr("flight.views: replanned requires the planner skycap; the planner see++"));
  EXPECT_THAT(error_message("flight.order", "survey"),
              HasSubstr("conflicts with flight.order: survey"));
  EXPECT_EQ(error_message("flight.vehicle", "none"), "") << "nothing is flown, and nothing chosen";
}

}  // namespace
}  // namespace skycap::missions
