#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/export/text.h"
#include "geometry/angle.h"
#include "missions/config/resolve.h"
#include "missions/package/fleet/timetable_verification.h"
#include "missions/package/settings.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing_support::thrown_message;
using tests::flight_mission;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

/// Returns the mission with the keys in `flight` instead of its vehicle.
std::string fleet_mission(const std::string& flight) {
  std::string text = flight_mission();
  const std::string vehicle = "vehicle: generic,";
  return text.replace(text.find(vehicle), vehicle.size(), flight + ",");
}

/// Returns the package of a survey for two vehicles. All tests below only read it.
const TestFolder& package() {
  static const TestFolder folder;
  static const bool is_made = [] {
    const std::string mission = folder.write(
        "m.yaml", fleet_mission("vehicles: [generic, generic_ardupilot], separation: 6, "
                                "timing_tolerance: 2"));
    const auto run = run_skycap({"plan", mission, "--out", folder / "out"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("  fleet     2 vehicles, "));
    EXPECT_THAT(run.out, HasSubstr("Before the flight (vehicle 2 (generic_ardupilot)):\n"));
    return true;
  }();
  EXPECT_TRUE(is_made);
  return folder;
}

json fleet_summary() {
  return json::parse(read_content(package() / "out/summary.json")).at("flight").at("fleet");
}

auto check(const std::string& route, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"check", package() / "m.yaml", "--route", route};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_skycap(arguments);
}

/// Copy of the package's fleet files that tests may corrupt.
class CorruptedFleet {
 public:
  CorruptedFleet() {
    for (const char* name : {"timetable.csv", "fleet-1.plan", "fleet-2.waypoints"}) {
      folder_.write(name, read_content(package() / ("out/" + std::string(name))));
    }
  }

  std::string table() const { return folder_ / "timetable.csv"; }

  /// Replaces a field of a line. Both are counted from 1.
  void set(std::size_t line, std::size_t field, const std::string& to) {
    std::vector<std::string> lines = flight::split_lines(read_content(table()));
    std::vector<std::string> fields = flight::split(lines.at(line - 1), ',');
    fields.at(field - 1) = to;
    std::string joined, all;
    for (const std::string& text : fields) joined += (joined.empty() ? "" : ",") + text;
    lines[line - 1] = joined;
    for (const std::string& text : lines) all += text + "\n";
    folder_.write("timetable.csv", all);
  }

  std::string get(std::size_t line, std::size_t field) const {
    return flight::split(flight::split_lines(read_content(table())).at(line - 1), ',')
        .at(field - 1);
  }

  TestFolder folder_;
};

TEST(Fleet, DividesAllWaypointsAndVerifiesFiles) {
  const json fleet = fleet_summary();
  const json summary = json::parse(read_content(package() / "out/summary.json"));
  std::vector<int> shared, alone = summary["flight"]["route"]["order"];
  for (const json& vehicle : fleet["vehicles"]) {
    for (const int view : vehicle["order"]) shared.push_back(view);
  }
  for (const json& missed : fleet["skipped_views"]) shared.push_back(missed["view"]);
  std::ranges::sort(shared);
  std::ranges::sort(alone);
  EXPECT_EQ(shared, alone);
  EXPECT_GE(fleet["makespan_s"], fleet["makespan_bound_s"]);
  EXPECT_GE(fleet["flown_s"], fleet["flown_bound_s"]);
  EXPECT_GE(fleet["separation"]["proven_m"], 6.0);

  const auto verification = check(package() / "out/timetable.csv");
  EXPECT_EQ(verification.exit_code, 0) << verification.out << verification.err;
  EXPECT_THAT(verification.out, HasSubstr(": verified, 2 sorties of 2 vehicles in "));
  for (const char* file : {"out/fleet-1.plan", "out/fleet-2.waypoints", "out/fleet-2.kml"}) {
    const auto own = check(package() / file);
    EXPECT_EQ(own.exit_code, 0) << file << own.out << own.err;
    EXPECT_THAT(own.out, HasSubstr(": verified, 0 of "));
  }
}

TEST(Fleet, KeepsSeparationInSimulatedFlights) {
  const auto run = run_skycap({"fly-test", package() / "out", "--flights", "20", "--returns", "0",
                               "--out", package() / "flown"});
  const json test = json::parse(read_content(package() / "flown/fly_test.json")).at("fleet");
  EXPECT_EQ(test["flights"], 20);
  EXPECT_EQ(test["nearer"], 0) << run.out;
  EXPECT_DOUBLE_EQ(test["limit_m"], 6.0 - 2.0 * (0.1 + 0.3));
  EXPECT_GE(test["least_m"], test["limit_m"]);
}

TEST(Fleet, RejectsTimetablesThatViolateSeparation) {
  CorruptedFleet corrupted;
  EXPECT_EQ(check(corrupted.table()).exit_code, 0);
  // The pads are 7 m apart, and both vehicles take off at the same time.
  corrupted.set(2, 5, "0");
  corrupted.set(3, 5, "0");
  const auto together = check(corrupted.table(), {"--set", "flight.separation=20"});
  EXPECT_EQ(together.exit_code, 1);
  EXPECT_THAT(together.out, HasSubstr("vehicle 1, fleet-1.plan and vehicle 2, fleet-2.waypoints "
                                      "may come within "));
  EXPECT_THAT(together.out, HasSubstr(": not verified, 2 sorties"));
}

TEST(Fleet, RejectsTimetablesThatContradictFiles) {
  CorruptedFleet late;
  late.set(2, 6, std::to_string(std::stod(late.get(2, 6)) + 5.0));
  const auto landing = check(late.table());
  EXPECT_EQ(landing.exit_code, 1);
  EXPECT_THAT(landing.out, HasSubstr("vehicle 1, fleet-1.plan lands at "));

  CorruptedFleet moved;
  json plan = json::parse(read_content(moved.folder_ / "fleet-1.plan"));
  constexpr int waypoint = 16;
  json& items = plan["mission"]["items"];
  const auto first =
      std::ranges::find_if(items, [](const json& item) { return item.at("command") == waypoint; });
  ASSERT_NE(first, items.end());
  (*first)["params"][6] = first->at("params").at(6).get<double>() + 30.0;
  moved.folder_.write("fleet-1.plan", plan.dump());
  EXPECT_NE(check(moved.table()).exit_code, 0);
}

TEST(Fleet, RejectsCorruptedRowsWithLineNumber) {
  const auto error_message = [](std::size_t line, std::size_t field, const std::string& to) {
    CorruptedFleet corrupted;
    corrupted.set(line, field, to);
    const auto run = check(corrupted.table());
    EXPECT_EQ(run.exit_code, 2) << run.out;
    return run.err;
  };
  EXPECT_THAT(error_message(1, 1, "drone"), HasSubstr("timetable.csv:1: is not a timetable"));
  EXPECT_THAT(error_message(3, 1, "3"), HasSubstr("timetable.csv:3: unknown vehicle 3"));
  EXPECT_THAT(error_message(3, 1, "x"), HasSubstr("timetable.csv:3: vehicle is \"x\""));
  EXPECT_THAT(error_message(2, 2, "m30t"), HasSubstr("timetable.csv:2: vehicle 1 is generic in"));
  EXPECT_THAT(error_message(3, 3, "0"), HasSubstr("timetable.csv:3: sortie is \"0\""));
  EXPECT_THAT(error_message(3, 4, "fleet-1.plan"), HasSubstr("is not one of fleet-2.*"));
  EXPECT_THAT(error_message(3, 4, "fleet-2.plan"), HasSubstr("fleet-2.plan"));
  EXPECT_THAT(error_message(3, 4, "fleet-2.plan/../../x.plan"),
              HasSubstr("is not one of fleet-2.*"));
  EXPECT_THAT(error_message(2, 5, "soon"), HasSubstr("timetable.csv:2: start_s is \"soon\""));
  EXPECT_THAT(error_message(2, 6, "-1"),
              HasSubstr("timetable.csv:2: the landing time must be after"));
  EXPECT_THAT(error_message(2, 9, "1e300"), HasSubstr("timetable.csv:2: pad"));
}

TEST(Fleet, ReassignsViewsOfLostVehicle) {
  const auto export_rest = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"export", package() / "out", "--format", "plan"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_skycap(arguments);
  };
  const std::size_t left = fleet_summary()["vehicles"][1]["order"].size();
  const auto all = export_rest({"--lost", "2", "--out", package() / "rest"});
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.out, HasSubstr("generic, " + std::to_string(left) + " views"));
  EXPECT_TRUE(std::filesystem::exists(package() / "rest/mission.plan"));

  const std::string landing = std::to_string(fleet_summary()["makespan_s"].get<double>() + 10.0);
  const auto none = export_rest({"--lost", "2", "--after", landing, "--out", package() / "none"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("the vehicle has captured all of its views by this time"));
  EXPECT_THAT(export_rest({"--lost", "2"}).err, HasSubstr("requires --out"));
  EXPECT_THAT(export_rest({"--lost", "3", "--out", package() / "none"}).err, HasSubstr("--lost 3"));
  EXPECT_THAT(export_rest({"--after", "3"}).err, HasSubstr("requires --lost"));
}

/// Views of each vehicle of the package as lines of a waypoint table.
std::vector<std::string> fleet_lines(bool has_vehicles) {
  const json summary = json::parse(read_content(package() / "out/summary.json"));
  std::vector<std::string> lines;
  std::size_t number = 0;
  for (const json& vehicle : summary["flight"]["fleet"]["vehicles"]) {
    ++number;
    for (const std::size_t view : vehicle["order"]) {
      const json& at = summary["per_view"][view];
      const std::vector<double> place = at["position"], direction = at["direction"];
      std::string line;
      for (const double value : place) line += flight::fixed(value, 6) + ",";
      line +=
          flight::fixed(geometry::degrees_per_radian * std::atan2(direction[0], direction[1]), 6);
      line += "," + flight::fixed(geometry::degrees_per_radian * std::asin(direction[2]), 6) + ",1";
      lines.push_back(has_vehicles ? line + "," + std::to_string(number) : line);
    }
  }
  return lines;
}

auto export_fleet(const std::vector<std::string>& lines, bool has_vehicles,
                  const std::string& out) {
  std::string text = "x,y,z,heading_deg,gimbal_pitch_deg,photos";
  text += has_vehicles ? ",vehicle\n" : "\n";
  for (const std::string& line : lines) text += line + "\n";
  return run_skycap({"export", package() / "out", "--route", package().write("edited.csv", text),
                     "--out", package() / out});
}

TEST(FleetRoute, FliesTheViewsOfEachVehicleAndKeepsTheSeparation) {
  const auto run = export_fleet(fleet_lines(true), true, "edited");
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const json fleet = fleet_summary();
  for (std::size_t v = 0; v < 2; ++v) {
    EXPECT_THAT(run.out,
                HasSubstr("vehicle " + std::to_string(v + 1) + " " +
                          (v == 0 ? "generic, " : "generic_ardupilot, ") +
                          std::to_string(fleet["vehicles"][v]["order"].size()) + " waypoint"));
  }
  EXPECT_THAT(run.out, HasSubstr("  separation minimum "));
  const auto verification = check(package() / "edited/timetable.csv");
  EXPECT_EQ(verification.exit_code, 0) << verification.out << verification.err;
}

TEST(FleetRoute, DividesViewsWithoutVehicles) {
  const auto run = export_fleet(fleet_lines(false), false, "divided");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ(check(package() / "divided/timetable.csv").exit_code, 0);
}

TEST(FleetRoute, NamesTheViewThatAVehicleCannotReach) {
  std::vector<std::string> lines = fleet_lines(true);
  const std::size_t comma = lines[1].find(',', lines[1].find(',') + 1);
  lines[1] = "0,0" + lines[1].substr(comma);  // inside the object
  const auto run = export_fleet(lines, true, "blocked");
  EXPECT_EQ(run.exit_code, 1) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("edited.csv: waypoint line 3 of vehicle 1: "));
  EXPECT_FALSE(std::filesystem::exists(package() / "blocked"));
}

TEST(FleetRoute, RejectsUnknownVehiclesAndMissionsWithoutResults) {
  std::vector<std::string> lines = fleet_lines(true);
  lines[0].back() = '3';
  EXPECT_THAT(export_fleet(lines, true, "none").err,
              HasSubstr("line 2: vehicle 3 is unknown; the fleet has 2 vehicles"));
  const auto run = run_skycap({"export", package() / "m.yaml", "--route", package() / "edited.csv",
                               "--out", package() / "none"});
  EXPECT_THAT(run.err, HasSubstr("requires the results folder of plan"));
}

// A list of one vehicle gives the same settings, survey and files as the single vehicle.
TEST(Fleet, EqualsSingleVehicleForListOfOne) {
  const auto settings = [](const std::string& flight) {
    return package::settings_json(config::parse_mission(fleet_mission(flight), "m.yaml"));
  };
  const auto alone = settings("vehicle: generic");
  EXPECT_EQ(settings("vehicles: [generic]"), alone);
  EXPECT_EQ(settings("vehicles: [generic], pads: [[-75, 0, 0]]"), alone);
  for (const char* key : {"flight.vehicles", "flight.pads", "flight.fleet_goal",
                          "flight.separation", "flight.timing_tolerance"}) {
    EXPECT_FALSE(alone.contains(key)) << key;
    EXPECT_TRUE(settings("vehicles: [generic, generic]").contains(key) ||
                std::string(key) == "flight.pads")
        << key;
  }
}

TEST(Fleet, UsesMaxPositionErrorOfVehicles) {
  const auto position_error = [](const std::string& flight) {
    return config::parse_mission(fleet_mission(flight), "m.yaml").flight().position_error;
  };
  EXPECT_EQ(position_error("vehicle: m350_rtk"), 0.1);
  EXPECT_EQ(position_error("vehicle: mavic_3e, clearance: 3"), 1.5);
  EXPECT_EQ(position_error("vehicle: mavic_3e, position_error: 0.2"), 0.2);
  EXPECT_EQ(position_error("vehicles: [m350_rtk, mavic_3e], clearance: 3"), 1.5);
}

// 0.32 + 1.5 + 0.3 + 0.1 m: without RTK the default clearance of 2 m is too small.
TEST(Fleet, RejectsClearanceBelowErrorsWithoutRtk) {
  EXPECT_THAT(
      thrown_message([] { config::parse_mission(fleet_mission("vehicle: mavic_3e"), "m.yaml"); }),
      HasSubstr("key flight.clearance"));
}

TEST(Fleet, RejectsContradictoryKeys) {
  const auto error_message = [](const std::string& flight) {
    return thrown_message([&] { config::parse_mission(fleet_mission(flight), "m.yaml"); });
  };
  EXPECT_THAT(error_message("vehicle: m30t, vehicles: [generic, generic]"),
              HasSubstr("key flight.vehicle must be the first vehicle in flight.vehicles"));
  EXPECT_THAT(error_message("vehicles: [generic, no_such]"), HasSubstr("key flight.vehicles: "));
  EXPECT_THAT(error_message("vehicles: [generic, generic], pads: [[-75, 0, 0]]"),
              HasSubstr("key flight.pads has 1 take-off points for 2"));
  EXPECT_THAT(error_message("vehicles: [generic, generic], pads: [[-70, 0, 0], [-75, 0, 0]]"),
              HasSubstr("key flight.takeoff must be the first position in flight.pads"));
  EXPECT_THAT(error_message("vehicle: generic, separation: 8"),
              HasSubstr("key flight.separation requires flight.vehicles"));
  EXPECT_THAT(error_message("vehicle: generic, vehicles: [], pads: [[-75, 0, 0]]"),
              HasSubstr("key flight.pads requires flight.vehicles"));
  EXPECT_THAT(error_message("vehicles: [generic, generic], separation: 1"),
              HasSubstr("key flight.separation must be at least the sum of"));
  EXPECT_THAT(error_message("vehicles: [generic, generic], style: fly-through"),
              HasSubstr("key flight.style conflicts with flight.vehicles"));
}

// In a row along the target's side with the first pad, alternately on both sides of that pad.
TEST(Fleet, PutsDefaultPadsInRow) {
  const config::MissionSetup mission = config::parse_mission(
      fleet_mission("vehicles: [generic, generic, generic], separation: 9"), "m.yaml");
  const std::vector<Eigen::Vector3d> pads = mission.flight().fleet_pads({-75, 0, 0});
  ASSERT_EQ(pads.size(), 3U);
  EXPECT_EQ(pads[0], Eigen::Vector3d(-75, 0, 0));
  EXPECT_EQ(pads[1], Eigen::Vector3d(-75, 10, 0));
  EXPECT_EQ(pads[2], Eigen::Vector3d(-75, -10, 0));
}

}  // namespace
}  // namespace skycap::missions
