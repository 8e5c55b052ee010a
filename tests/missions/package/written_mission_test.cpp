// The printed coverage is the coverage of the written files.
#include "missions/package/written_mission.h"

#include <algorithm>
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/interpreter/interpret.h"
#include "geometry/angle.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/field_sheet.h"
#include "missions/simulation/measurement.h"
#include "tests/missions/results_in.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

/// Survey by a DJI vehicle that takes off next to its target. Within 50 m, the vehicle returns at
/// its current altitude, and some views have no verified return.
const std::string near_pad =
    "scene: {model: 'builtin:teapot', longest_side: 20.0, ground: true}\n"
    "sensor: {width: 160, height: 120, max_range: 100, noise: {sigma: 0.02}}\n"
    "planner: {name: skycap, density: 1, resolution_radius: 1.2, spacing: 0.3, view_distance: 16,\n"
    "          scene_box: {min: [-14, -11, 0.3], max: [14, 11, 13]}, min_gain: 0.02}\n"
    "flight: {vehicle: mavic_3e, position_error: 0.1, takeoff: [-30, 0, 0], views: survey,\n"
    "         unknown_box: {min: [-14, -11, 0], max: [14, 11, 13]}}\n"
    "site: {latitude_deg: 47.1, longitude_deg: 8.2, ellipsoid_height: 480,\n"
    "       geoid_undulation: 48}\n"
    "evaluation: {coverage_distance: 0.6, samples: 3000, visible_directions: 30,\n"
    "             attainable_views: 0}\n"
    "limits: {max_views: 14}\n";

struct Planned {
  TestFolder folder;
  std::string out;

  explicit Planned(const std::string& mission) {
    const std::string file = folder.write("m.yaml", mission);
    const auto run = run_skycap({"plan", file, "--out", folder / "package", "--no-report"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    out = run.out;
  }

  json summary() const { return json::parse(read_content(folder / "package/summary.json")); }
};

const Planned& far_away() {
  static const Planned planned(tests::flight_mission());
  return planned;
}

const Planned& beside() {
  static const Planned planned(near_pad);
  return planned;
}

/// Returns the coverage of the visible surface by the captures of the file, with noise from another
/// seed.
double covered_by(const Planned& planned, const std::string& name) {
  const config::MissionSetup setup = config::read_mission(planned.folder / "m.yaml", {});
  const evaluation::SurveyScene scene(setup.simulation, planned.folder.path(), 1);
  flight::FlightFacts facts = setup.flight().facts();
  const flight::InterpretedRoute route =
      flight::interpret_file(planned.folder / ("package/" + name), facts);
  std::vector<session::ViewInFlight> views;
  for (const flight::InterpretedStop& stop : route.stops) {
    views.push_back({.view = {stop.position, flight::compute_direction(
                                                 {geometry::radians_per_degree * stop.yaw_deg,
                                                  geometry::radians_per_degree * stop.pitch_deg})},
                     .time = 10.0 * static_cast<double>(views.size())});
  }
  const auto covered =
      simulation::reflight_coverage(setup.simulation, scene, views, setup.run.seed + 5, 1);
  return evaluation::covered_share(covered.stored, scene.visible(1)).value();
}

void expect_true_figures(const Planned& planned, const std::vector<std::string>& names) {
  const json written = planned.summary().at("flight").at("written");
  for (const std::string& name : names) {
    bool is_listed = false;
    for (const json& part : written) {
      if (std::ranges::find(part.at("files"), json(name)) == part.at("files").end()) continue;
      is_listed = true;
      EXPECT_NEAR(part.at("coverage_visible").get<double>(), covered_by(planned, name), 0.005)
          << name;
    }
    EXPECT_TRUE(is_listed) << name;
  }
}

TEST(WrittenMission, CoverageIsThatOfTheFilesFlownAgain) {
  expect_true_figures(far_away(), {"mission.plan", "mission.waypoints"});
  expect_true_figures(beside(), {"mission.kmz"});
}

TEST(WrittenMission, ViewsWithoutAReturnAreMissingFromTheFigures) {
  const json summary = beside().summary(), part = summary.at("flight").at("written").at(0);
  const auto views = part.at("views").get<std::size_t>();
  ASSERT_LT(views, summary.at("views").get<std::size_t>());
  EXPECT_EQ(part.at("planned_views"), summary.at("views"));
  EXPECT_LT(part.at("coverage_visible").get<double>(),
            summary.at("coverage_visible").get<double>() - 0.01);
  EXPECT_THAT(beside().out, HasSubstr("  mission   route files, "));
  EXPECT_THAT(beside().out, HasSubstr("Warning: view "));
  EXPECT_THAT(beside().out,
              HasSubstr("move flight.takeoff more than 54 m (horizontal distance) away"));
}

TEST(WrittenMission, FormatsThatCaptureTheSameShareTheirFigures) {
  const json written = far_away().summary().at("flight").at("written");
  ASSERT_EQ(written.size(), 1U);
  EXPECT_EQ(written[0].at("files").size(), 5U);
}

// A file with a missing photo covers less: the figure depends on the file, not on the plan.
TEST(WrittenMission, ViewsThatAFileDoesNotCaptureAreNotFlown) {
  const package::PackagedSurvey survey = package::read_package(far_away().folder / "package", {});
  const flight::Route route =
      package::plan_flight(survey.flight, survey.measured, survey.pad, survey.views, survey.paths,
                           survey.landing_surfaces);
  TestFolder folder;
  geometry::OutputFolder out(folder / "out");
  const std::array formats{flight::Format::plan, flight::Format::csv};
  package::FlightFiles files =
      package::stage_flight(survey.name, survey.flight, route, survey.measured, formats, out);
  for (const flight::Format format : formats) {
    const auto views = written_views(survey.flight, route, files, format);
    ASSERT_EQ(views.size(), route.capture_points.size());
    for (package::FlightFile& file : files.written) {
      if (file.format == format) file.captures.pop_back();
    }
    EXPECT_EQ(written_views(survey.flight, route, files, format).size(), views.size() - 1);
  }
  files.written.clear();
  EXPECT_TRUE(written_views(survey.flight, route, files, flight::Format::plan).empty());
}

TEST(WrittenMission, FieldSheetSaysWhatTheCrewNeeds) {
  const std::string sheet = read_content(beside().folder / "package/field_sheet.html");
  const json flight = beside().summary().at("flight");
  EXPECT_THAT(sheet, HasSubstr("<svg"));
  EXPECT_THAT(sheet, Not(HasSubstr("<script")));
  EXPECT_THAT(sheet, HasSubstr("Set the RTH altitude to "));
  EXPECT_THAT(sheet, HasSubstr("return altitude above take-off"));
  EXPECT_THAT(sheet, HasSubstr("Expected gaps"));
  EXPECT_THAT(sheet, HasSubstr("is not in the route files"));
  EXPECT_THAT(sheet, HasSubstr("mission.kmz"));
  EXPECT_THAT(sheet, HasSubstr("47.1"));
}

}  // namespace
}  // namespace skycap::missions
