// A mission chosen anew from its survey to its files, by the program.

#include "missions/package/anew_mission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/config/resolve.h"
#include "missions/package/package.h"
#include "tests/missions/flown_mission.h"
#include "tests/missions/results_in.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using tests::content_of;
using tests::flown_mission;
using tests::run_skycap;
using tests::TestFolder;

/// A survey whose mission was chosen anew, and the same survey with its own views.
const TestFolder& packages() {
  static const TestFolder folder;
  static const bool are_made = [] {
    const std::string mission = folder.write("m.yaml", flown_mission());
    const auto anew = run_skycap({"plan", mission, "--out", folder / "anew", "--threads", "1",
                                  "--set", "flight.views=replanned"});
    EXPECT_EQ(anew.exit_code, 0) << anew.err;
    EXPECT_THAT(anew.out, HasSubstr("  coverage  "));
    const auto survey = run_skycap({"plan", mission, "--out", folder / "survey"});
    EXPECT_EQ(survey.exit_code, 0) << survey.err;
    return true;
  }();
  EXPECT_TRUE(are_made);
  return folder;
}

json summary_of(const std::string& package) {
  return json::parse(content_of(packages() / (package + "/summary.json")));
}

TEST(AnewMission, IsFasterAndPromisesNoLess) {
  const json flight = summary_of("anew").at("flight");
  const json& anew = flight.at("replanned");
  ASSERT_TRUE(anew.at("is_flown").get<bool>());
  const auto figure = [&](const char* whose, const char* name) {
    return anew.at(whose).at(name).get<double>();
  };
  EXPECT_LT(figure("replanned", "duration_s"), figure("survey", "duration_s"));
  EXPECT_GE(figure("replanned", "predicted_coverage"),
            figure("survey", "predicted_coverage") - 5e-4);
  EXPECT_EQ(flight.at("route").at("duration_s"), anew.at("replanned").at("duration_s"));
  EXPECT_EQ(flight.at("route").at("length_m"), anew.at("replanned").at("length_m"));
  EXPECT_EQ(flight.at("route").at("stations"), anew.at("stations").size());
  EXPECT_TRUE(flight.at("route").at("skipped_views").empty());
  std::size_t pieces = 0;
  for (const json& sortie : flight.at("route").at("sorties")) {
    for (const json& leg : sortie.at("legs")) pieces += leg.at("points").size() - 1;
  }
  EXPECT_EQ(anew.at("replanned").at("pieces").get<std::size_t>(), pieces);
}

// What it is compared with is the mission that the survey leaves without it.
TEST(AnewMission, IsComparedWithTheSurveysOwn) {
  const json own = summary_of("survey").at("flight");
  EXPECT_FALSE(own.contains("replanned"));
  const json compared = summary_of("anew").at("flight").at("replanned").at("survey");
  EXPECT_EQ(compared.at("duration_s"), own.at("route").at("duration_s"));
  EXPECT_EQ(compared.at("length_m"), own.at("route").at("length_m"));
  EXPECT_EQ(compared.at("views"), own.at("route").at("stations"));
}

TEST(AnewMission, LeavesTheSurveyAsItIs) {
  const TestFolder& folder = packages();
  for (const char* name : {"views.csv", "cloud.ply", "coverage.ply", "free_space.bin"}) {
    EXPECT_EQ(content_of(folder / ("anew/" + std::string(name))),
              content_of(folder / ("survey/" + std::string(name))))
        << name;
  }
}

// The dose model promises shares of what was measured, the judge measures shares of what is
// visible: of this teapot nearly the same. A tenth is more than both scatter by.
TEST(AnewMission, KeepsItsPromiseWhenItIsFlownAgain) {
  const json summary = summary_of("anew");
  const double again =
      summary.at("flight").at("replanned").at("reflight").at("coverage_visible").get<double>();
  EXPECT_GT(again, summary.at("coverage_visible").get<double>() - 0.1);
  EXPECT_LE(again, 1.0);
}

// Frames on the survey's ways have seen what its few views have not: the mission is to cover that.
TEST(AnewMission, CoversWhatTheFramesOnTheSurveysWaysHaveSeen) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "moving", "--set",
                               "flight.views=replanned", "--set", "sensor.capture=moving"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json anew = summary_of("moving").at("flight").at("replanned");
  ASSERT_TRUE(anew.at("is_flown").get<bool>());
  EXPECT_GT(anew.at("replanned").at("predicted_coverage").get<double>(),
            anew.at("survey").at("predicted_coverage").get<double>() + 0.01);
  EXPECT_GT(anew.at("reflight").at("coverage_visible_unthinned").get<double>(),
            anew.at("survey_reflight").at("coverage_visible_unthinned").get<double>() - 0.005);
}

TEST(AnewMission, DoesNotDependOnThreads) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "threads", "--threads",
                               "4", "--set", "flight.views=replanned"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::vector<std::string> timed = {"summary.json", "report.html"};
  EXPECT_EQ(tests::results_in(folder / "anew", timed),
            tests::results_in(folder / "threads", timed));
}

// Against the scene as it is, every leg of every file.
TEST(AnewMission, FilesKeepTheClearanceFromTheTruth) {
  const TestFolder& folder = packages();
  for (const char* ending : {"plan", "waypoints", "kml", "geojson", "csv"}) {
    const auto check = run_skycap(
        {"check", folder / "m.yaml", "--route", folder / ("anew/mission." + std::string(ending))});
    EXPECT_EQ(check.exit_code, 0) << ending << check.out << check.err;
    EXPECT_THAT(check.out, HasSubstr(": verified, 0 of "));
  }
}

// Past its views: faster than with stops, each view's picture in the trajectory, and proven.
TEST(AnewMission, IsFlownPastItsViews) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"plan", folder / "m.yaml", "--out", folder / "passing", "--threads",
                               "1", "--set", "flight.views=replanned", "--set",
                               "flight.style=fly-through", "--set", "sensor.exposure=0.0005"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("  passing   "));
  const json stopping = summary_of("anew").at("flight"),
             passing = summary_of("passing").at("flight");
  const auto& sorties = passing.at("route").at("sorties");
  ASSERT_EQ(sorties.size(), 1U);
  const json passage = sorties[0].at("passage");
  ASSERT_FALSE(passage.is_null());
  EXPECT_LT(passage.at("duration_s").get<double>(), sorties[0].at("duration_s").get<double>());
  EXPECT_LT(passing.at("replanned").at("replanned").at("duration_s").get<double>(),
            stopping.at("replanned").at("replanned").at("duration_s").get<double>());
  EXPECT_GE(passage.at("clearance_m").get<double>(),
            passing.at("clearance_m").at("total").get<double>());
  const std::string csv = content_of(folder / "passing/mission.csv");
  std::size_t shots = 0;
  for (std::size_t at = csv.find(",1\n"); at != std::string::npos; at = csv.find(",1\n", at + 1)) {
    ++shots;
  }
  EXPECT_EQ(shots, passage.at("views").size());
  EXPECT_EQ(shots, passing.at("route").at("stations").get<std::size_t>());
  for (const char* name : {"passing/mission.csv", "passing/mission.kml", "passing/mission.plan"}) {
    const auto check = run_skycap({"check", folder / "m.yaml", "--route", folder / name});
    EXPECT_EQ(check.exit_code, 0) << name << check.out << check.err;
  }
  const auto exported = run_skycap(
      {"export", folder / "passing", "--format", "csv", "--out", folder / "passing again"});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_EQ(content_of(folder / "passing again/mission.csv"), csv);
}

TEST(AnewMission, SaysWhyNothingIsPassed) {
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
              HasSubstr("flight.style: fly-through conflicts with a sensor that must rest"));
}

TEST(AnewMission, IsExportedAgainAsItWasPlanned) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"export", folder / "anew", "--format", "plan", "--format", "csv",
                               "--out", folder / "again"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* file : {"mission.plan", "mission.csv"}) {
    EXPECT_EQ(content_of(folder / ("again/" + std::string(file))),
              content_of(folder / ("anew/" + std::string(file))));
  }
  const auto flown = run_skycap({"fly-test", folder / "anew", "--flights", "2", "--returns", "20",
                                 "--out", folder / "flown"});
  EXPECT_EQ(flown.exit_code, 0) << flown.out << flown.err;
}

// On request the survey's own mission is written after all.
TEST(AnewMission, GivesBackTheSurveysMission) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"export", folder / "anew", "--format", "csv", "--set",
                               "flight.views=survey", "--out", folder / "back"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(content_of(folder / "back/mission.csv"), content_of(folder / "survey/mission.csv"));
}

TEST(AnewMission, IsNotMadeOfASurveyThatDidNotAskForIt) {
  const TestFolder& folder = packages();
  const auto run = run_skycap({"export", folder / "survey", "--format", "csv", "--set",
                               "flight.views=replanned", "--out", folder / "refused"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("summary.json: contains no replanned views; plan the mission "
                                 "again, or set flight.views=survey"));
  EXPECT_FALSE(std::filesystem::exists(folder / "refused/mission.csv"));
}

TEST(AnewMission, RefusesStationsThatAreNowhere) {
  json summary = summary_of("anew");
  summary["flight"]["replanned"]["stations"][1]["way"][0][2] = 1e300;
  EXPECT_THAT(testing_support::complaint_of(
                  [&] { package::parse_package_summary(summary.dump(), "summary.json"); }),
              HasSubstr("summary.json: flight.replanned.stations[1].way"));
}

TEST(AnewMission, NeedsAPlannerThatKnowsTheSurface) {
  const auto complaint = [](const std::string& key, const std::string& value) {
    return testing_support::complaint_of([&] {
      config::parse_mission(flown_mission(), "m.yaml",
                            {{"--set", "flight.views", "anew"}, {"--set", key, value}});
    });
  };
  EXPECT_THAT(complaint("planner.name", "see++"),
              HasSubstr("flight.views: replanned requires the planner skycap; the planner see++"));
  EXPECT_THAT(complaint("flight.order", "survey"),
              HasSubstr("conflicts with flight.order: survey"));
  EXPECT_EQ(complaint("flight.vehicle", "none"), "") << "nothing is flown, and nothing chosen";
}

}  // namespace
}  // namespace skycap::missions
