// Commands on inspections: plan, fly-test, export and benchmark.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/export/text.h"
#include "tests/missions/inspection/block.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing::Not;
using tests::ProgramRun;
using tests::read_content;
using tests::run_skycap;
using Json = nlohmann::json;

constexpr const char* block_yaml = R"(
name: block
site: {latitude_deg: 51.7535, longitude_deg: -1.254, ellipsoid_height: 111.5, geoid_undulation: 46.7}
sensor: {photo_camera: mavic_3e_wide}
inspection: {range: 7, share: 0.9, spacing: 0.25, moves: 1500, searches: 1}
prior: [{file: block.obj, role: target, uncertainty: 0.1}]
flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}
)";

class InspectionCommands : public testing::Test {
 protected:
  InspectionCommands() { folder_.write("block.obj", block_obj); }

  ProgramRun plan(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"plan", mission_, "--out", out(), "--no-report"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_skycap(arguments);
  }
  ProgramRun export_to(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"export", out()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run_skycap(all);
  }
  std::string out() const { return folder_ / "out"; }
  bool exists(const std::string& name) const {
    return std::filesystem::exists(folder_.path() / name);
  }

  tests::TestFolder folder_;
  std::string mission_ = folder_.write("block.yaml", block_yaml);
};

class InspectionFlyTest : public InspectionCommands,
                          public testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(Vehicles, InspectionFlyTest,
                         testing::Values("mavic_3e", "generic", "generic_ardupilot"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(InspectionFlyTest, KeepsTheClearanceInWindAndOnReturn) {
  const std::string vehicle = std::string("flight.vehicle=") + GetParam();
  ASSERT_EQ(plan({"--set", vehicle}).exit_code, 0);
  const ProgramRun flown = run_skycap({"fly-test", out(), "--flights", "6", "--returns", "100"});
  EXPECT_EQ(flown.exit_code, 0) << flown.out << flown.err;
  const Json test = Json::parse(read_content(folder_.path() / "out" / "fly_test.json"));
  const Json summary = Json::parse(read_content(folder_.path() / "out" / "summary.json"));
  ASSERT_FALSE(test["files"].empty());
  for (const Json& file : test["files"]) {
    // The simulation stops at the waypoints that are passed.
    EXPECT_GT(file["time_s"]["median"].get<double>(),
              summary["flight"]["route"]["duration_s"].get<double>());
  }
}

TEST_F(InspectionCommands, ExportForAnotherVehicle) {
  ASSERT_EQ(plan().exit_code, 0);
  const ProgramRun run =
      export_to({"--format", "waypoints", "--format", "plan", "--set",
                 "flight.vehicle=generic_ardupilot", "--out", folder_ / "ardupilot"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(exists("ardupilot/mission.waypoints"));
  EXPECT_TRUE(exists("ardupilot/mission.plan"));
  EXPECT_TRUE(exists("out/mission.kmz")) << "remains in the package";
  EXPECT_THAT(run.out, HasSubstr("from the planned curve"));
  EXPECT_THAT(run.out, HasSubstr("Before the flight (generic_ardupilot)"));
}

TEST_F(InspectionCommands, ExportOfTheSameFormatGivesTheSameFile) {
  ASSERT_EQ(plan().exit_code, 0);
  const auto setpoints = [&](const std::string& folder) {
    return read_content(folder_.path() / folder / "setpoints.ned.csv").size();
  };
  const ProgramRun run = export_to(
      {"--format", "kmz", "--format", "ned-csv", "--format", "tum", "--out", folder_ / "again"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  // The flight is read with the rounding of inspection.csv.
  EXPECT_NEAR(static_cast<double>(setpoints("again")), static_cast<double>(setpoints("out")), 1e3);
  EXPECT_TRUE(exists("again/mission.kmz"));
  EXPECT_TRUE(exists("again/camera.tum"));
}

TEST_F(InspectionCommands, ExportRejectsFormatsThatCannotCommandTheFlight) {
  ASSERT_EQ(plan().exit_code, 0);
  EXPECT_THAT(export_to({"--format", "litchi"}).err,
              HasSubstr("--format litchi commands neither an even rotation of the camera nor a "
                        "recording"));
  EXPECT_THAT(export_to({"--format", "plan"}).err,
              HasSubstr("--format plan requires a PX4 or ArduPilot vehicle, and the flight is for "
                        "mavic_3e; add --set flight.vehicle=generic"));
  EXPECT_THAT(export_to({"--format", "kmz", "--lost", "1", "--out", folder_ / "lost"}).err,
              HasSubstr("--lost requires a fleet"));
  EXPECT_THAT(export_to({"--format", "kmz", "--set", "flight.clearance=6"}).err,
              HasSubstr("no waypoint can be reached"));
}

class EditedInspection : public InspectionCommands {
 protected:
  EditedInspection() { EXPECT_EQ(plan().exit_code, 0); }

  /// Returns the lines of corners.csv, the header first.
  std::vector<std::string> corners() const {
    return flight::split_lines(read_content(folder_.path() / "out" / "corners.csv"));
  }
  ProgramRun verify(const std::vector<std::string>& lines, const std::string& out = "edited",
                    const std::vector<std::string>& more = {}) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    std::vector<std::string> arguments{"--route", folder_.write("edited.csv", text), "--out",
                                       folder_ / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return export_to(arguments);
  }
  Json summary(const std::string& folder) const {
    return Json::parse(read_content(folder_.path() / folder / "summary.json"));
  }
};

TEST_F(EditedInspection, EqualsThePlanForUnchangedCorners) {
  const ProgramRun run = verify(corners());
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("block: verified\n"));
  EXPECT_THAT(run.out, Not(HasSubstr("slowed")));
  const Json planned = summary("out")["inspection"], edited = summary("edited")["inspection"];
  EXPECT_NEAR(edited["duration_s"], planned["duration_s"], 1e-4);
  EXPECT_NEAR(edited["verified_clearance_m"], planned["verified_clearance_m"], 1e-4);
  EXPECT_NEAR(edited["evaluation"]["incidence"]["share"],
              planned["evaluation"]["incidence"]["share"], 2e-3);
  EXPECT_EQ(edited["attainable_points"], planned["attainable_points"]);
  EXPECT_TRUE(edited["search"].is_null());
  for (const char* name : {"mission.kmz", "camera.tum", "structure.ply", "report.html"}) {
    EXPECT_TRUE(exists(std::string("edited/") + name)) << name;
  }
}

TEST_F(EditedInspection, IsAnInspectionThatIsEditedExportedAndFlownAgain) {
  std::vector<std::string> lines = corners();
  std::vector<std::string> fields = flight::split(lines[3], ',');
  fields[2] = std::to_string(std::stod(fields[2]) + 1.0);  // a metre higher
  lines[3] = fields[0];
  for (std::size_t i = 1; i < fields.size(); ++i) lines[3] += "," + fields[i];
  const ProgramRun run = verify(lines);
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NEAR(summary("edited")["inspection"]["vertices"][2]["position"][2], std::stod(fields[2]),
              1e-6);
  const ProgramRun flown =
      run_skycap({"fly-test", folder_ / "edited", "--flights", "3", "--returns", "10"});
  EXPECT_EQ(flown.exit_code, 0) << flown.out << flown.err;
  const ProgramRun again = run_skycap({"export", folder_ / "edited", "--route",
                                       folder_ / "edited/corners.csv", "--out", folder_ / "again"});
  EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
  EXPECT_EQ(read_content(folder_.path() / "again" / "corners.csv"),
            read_content(folder_.path() / "edited" / "corners.csv"));
}

TEST_F(EditedInspection, WritesNothingIfALegViolatesTheClearance) {
  std::vector<std::string> lines = corners();
  lines[4] = "0,0,6,0,-30,0";  // a metre above the block
  const ProgramRun run = verify(lines);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("leg 4 (line 5 to line 6): "));
  EXPECT_THAT(run.out, HasSubstr("at least 2.2 m required (clearance 2 m + 0.2 m for the flown"));
  EXPECT_THAT(run.out, HasSubstr("; move the corners; no file written"));
  EXPECT_FALSE(exists("edited"));
}

TEST_F(EditedInspection, RejectsUnsuitableFilesFoldersAndOptions) {
  std::vector<std::string> lines = corners();
  EXPECT_THAT(verify(lines, "edited", {"--repair"}).err, HasSubstr("contains the corners of an"));
  EXPECT_THAT(verify({lines[0]}).err, HasSubstr("edited.csv:1: contains no corner"));
  EXPECT_THAT(verify({lines[0], lines[1]}).err, HasSubstr("at least two corners"));
  for (const char* row : {"1,2,3,4,5", "1,2,3,4,5,-1", "1,2,3,400,5,0", "1,2,3,4,95,0",
                          "1,2,x,4,5,0", "1e9,2,3,4,5,0", "1,2,3,4,5,6,7"}) {
    EXPECT_THAT(verify({lines[0], lines[1], row}).err, HasSubstr("edited.csv:3: ")) << row;
  }
  const ProgramRun mission = run_skycap(
      {"export", mission_, "--route", folder_ / "edited.csv", "--out", folder_ / "edited"});
  EXPECT_THAT(mission.err, HasSubstr("is not the results folder of an inspection"));
  EXPECT_FALSE(exists("edited"));
}

TEST_F(InspectionCommands, FlyTestStatesThatThereAreNoRouteFiles) {
  ASSERT_EQ(plan({"--set", "site.max_height=9"}).exit_code, 0);
  const ProgramRun flown = run_skycap({"fly-test", out()});
  EXPECT_NE(flown.exit_code, 0);
  EXPECT_THAT(flown.err, HasSubstr("summary.json is an inspection without route files"));
}

TEST_F(InspectionCommands, BenchmarkComparesFlightsOfOtherPrograms) {
  ASSERT_EQ(plan().exit_code, 0);
  folder_.write("rows.csv", read_content(folder_.path() / "out" / "inspection.csv"));
  const std::string missing =
      folder_.write("missing.yaml",
                    "name: missing\n"
                    "inspection: {range: 7, cloud: nowhere.ply}\n"
                    "flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, "
                    "clearance: 2}\n");
  const ProgramRun run = run_skycap(
      {"benchmark", mission_, missing, "--trials", "2", "--also", "block=" + (folder_ / "rows.csv"),
       "--also", "block=" + (folder_ / "none.csv"), "--out", folder_ / "compared"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(read_content(folder_.path() / "compared" / "inspections.json"));
  const Json& flights = json["flights"];
  ASSERT_EQ(flights.size(), 5U) << json;
  EXPECT_EQ(flights[0]["flight"], "rows.csv");
  EXPECT_THAT(flights[1]["skipped"].get<std::string>(), HasSubstr("none.csv"));
  EXPECT_EQ(flights[2]["flight"], "skycap, seed 1");
  EXPECT_EQ(flights[3]["flight"], "skycap, seed 2");
  EXPECT_THAT(flights[4]["skipped"].get<std::string>(), HasSubstr("nowhere.ply"));
  // Planned without the additional clearance for the deviation of autopilots.
  EXPECT_NEAR(flights[2]["duration_s"].get<double>() / flights[0]["duration_s"].get<double>(), 1.0,
              0.5);
  EXPECT_GT(flights[2]["views_per_point"]["median"].get<double>(), 0.0);
  EXPECT_THAT(run.out, HasSubstr("| block | rows.csv | "));
  EXPECT_THAT(run.out, HasSubstr("- missing, all flights: skipped: "));
}

TEST_F(InspectionCommands, BenchmarkRejectsUnclearFlights) {
  EXPECT_THAT(run_skycap({"benchmark", mission_, "--also", "rows.csv"}).err,
              HasSubstr("--also rows.csv: must be MISSION=FILE for inspections"));
  EXPECT_THAT(run_skycap({"benchmark", mission_, "--also", "tower=rows.csv"}).err,
              HasSubstr("--also tower=rows.csv: no mission has this name; expected block"));
  EXPECT_THAT(run_skycap({"benchmark", mission_, "--scenes", "garage"}).err,
              HasSubstr("--scenes conflicts with inspections"));
}

}  // namespace
}  // namespace skycap::missions
