// A simulated flight with known errors, logged in two formats and compared with its plan.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/export/trajectory_file.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/package/replanned_mission.h"
#include "tests/flight/flown/flown_logs.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using flight::FlownState;
using testing::HasSubstr;
using Json = nlohmann::json;

const flight::Site site{{47.1, 8.2, 480.0}, 48.0};

/// A planned survey of a teapot, and its planned flight.
class FlightComparisonTest : public testing::Test {
 protected:
  FlightComparisonTest() {
    const std::string mission = folder_.write("teapot.yaml", tests::flight_mission());
    const tests::ProgramRun plan = tests::run_skycap(
        {"plan", mission, "--seed", "2", "--out", folder_ / "teapot", "--no-report"});
    EXPECT_EQ(plan.exit_code, 0) << plan.err;
    const auto states =
        flight::read_trajectory_csv(tests::read_content(folder_ / "teapot/mission.csv"));
    for (const flight::TimedState& state : states) {
      const double yaw_deg = state.yaw / geometry::radians_per_degree;
      flight_.push_back({{state.time, state.position, yaw_deg, yaw_deg,
                          state.pitch / geometry::radians_per_degree},
                         state.is_capture});
    }
    for (std::size_t i = 0; i < flight_.size(); ++i) {
      if (flight_[i].is_capture) captures_.push_back(i);
    }
  }

  /// Returns the flight 0.5 m farther east, past station `skipped`, and without the captures at two
  /// further stations.
  std::vector<FlownState> faulty_flight(std::size_t skipped, std::size_t untriggered_1,
                                        std::size_t untriggered_2) const {
    std::vector<FlownState> flown(
        flight_.begin(),
        flight_.begin() + static_cast<std::ptrdiff_t>(captures_.at(skipped - 1) + 1));
    const FlownState from = flown.back();
    const FlownState& to = flight_[captures_.at(skipped + 1)];
    const Vector3d displacement = to.state.position - from.state.position;
    const int count = static_cast<int>(displacement.norm() / 0.4);
    for (int k = 1; k < count; ++k) {
      FlownState state = from;
      state.is_capture = false;
      state.state.time = flown.back().state.time + 0.1;
      state.state.position += displacement * k / count;
      flown.push_back(state);
    }
    for (std::size_t i = captures_.at(skipped + 1); i < flight_.size(); ++i) {
      FlownState state = flight_[i];
      state.is_capture =
          state.is_capture && i != captures_.at(untriggered_1) && i != captures_.at(untriggered_2);
      state.state.time = flown.back().state.time + 0.1;
      flown.push_back(state);
    }
    for (FlownState& state : flown) state.state.position.x() += 0.5;
    return flown;
  }

  /// Returns the coverage of the visible surface by captures at these exact poses.
  double true_coverage(const std::vector<FlownState>& flown) const {
    const config::MissionSetup setup =
        package::read_package_summary(folder_ / "teapot", {}).mission;
    const evaluation::SurveyScene scene(setup.simulation, {}, 2);
    std::vector<session::ViewInFlight> views;
    for (const FlownState& state : flown) {
      if (!state.is_capture) continue;
      constexpr double degree = geometry::radians_per_degree;
      views.push_back({.view = {state.state.position,
                                flight::compute_direction({degree * state.state.camera_yaw_deg,
                                                           degree * state.state.camera_pitch_deg})},
                       .time = state.state.time});
    }
    const auto covered =
        simulation::reflight_coverage(setup.simulation, scene, views, setup.run.seed, 2);
    return evaluation::covered_share(covered.stored, scene.visible(2)).value();
  }

  Json compare(const std::vector<std::string>& logs, int exit_code) const {
    std::vector<std::string> arguments{"compare", folder_ / "teapot"};
    arguments.insert(arguments.end(), logs.begin(), logs.end());
    const tests::ProgramRun run = tests::run_skycap(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
    return Json::parse(tests::read_content(folder_ / "teapot/compare/compare.json"));
  }

  tests::TestFolder folder_;
  const Vector3d pad_{-75.0, 0.0, 0.0};
  std::vector<FlownState> flight_;
  std::vector<std::size_t> captures_;  ///< Indices in `flight_`.
};

TEST_F(FlightComparisonTest, FindsNoErrorInAnExactFlight) {
  const Json json =
      compare({folder_.write("exact.bin", flight::write_dataflash(flight_, site, pad_))}, 0);
  EXPECT_EQ(json["captures"]["missed"], 0);
  EXPECT_EQ(json["captures"]["source"], "log");
  EXPECT_TRUE(json["patch"].is_null());
  for (const Json& leg : json["legs"]) EXPECT_LT(leg["max_error_m"], 0.1);
  EXPECT_NEAR(json["coverage"]["flown"]["coverage_visible"].get<double>(),
              json["coverage"]["planned"]["coverage_visible"].get<double>(), 0.01);
}

TEST_F(FlightComparisonTest, FindsKnownErrorsAndClosesThem) {
  ASSERT_EQ(captures_.size(), 6);
  const std::vector<FlownState> flown = faulty_flight(2, 4, 5);
  const double truth = true_coverage(flown), whole = true_coverage(flight_);
  for (const bool is_ulog : {false, true}) {
    SCOPED_TRACE(is_ulog);
    const Json json =
        compare({is_ulog ? folder_.write("faulty.ulg", flight::write_ulog(flown, site, pad_))
                         : folder_.write("faulty.bin", flight::write_dataflash(flown, site, pad_))},
                1);
    const Json& legs = json["legs"];
    ASSERT_EQ(legs.size(), 7);
    for (std::size_t i = 0; i < legs.size(); ++i) {
      EXPECT_EQ(legs[i]["flown"], i != 2 && i != 3) << i;
      if (legs[i]["flown"]) {
        EXPECT_LT(legs[i]["max_error_m"], 0.55) << i;
      }
    }
    const Json& captures = json["captures"];
    EXPECT_EQ(captures["missed"], 3);
    for (std::size_t i = 0; i < captures["list"].size(); ++i) {
      const Json& capture = captures["list"][i];
      EXPECT_EQ(capture["missed"], i == 2 || i == 4 || i == 5) << i;
      if (capture["made"]) {
        EXPECT_NEAR(capture["error_m"].get<double>(), 0.5, 0.03) << i;
      }
    }
    EXPECT_NEAR(captures["mean_offset_m"][0].get<double>(), 0.5, 0.02);
    EXPECT_NEAR(captures["mean_offset_m"][1].get<double>(), 0.0, 0.02);
    const double min_distance = json["clearance"]["min_cloud_distance_m"].get<double>();
    EXPECT_LT(min_distance, 10.0);

    // The track in the report is the flight that was logged.
    ASSERT_EQ(json["track"].size(), 1);
    const Json& track = json["track"][0];
    ASSERT_EQ(track["points"].size(), track["distances_m"].size());
    for (const Json& distance : track["distances_m"]) {
      EXPECT_TRUE(distance.is_null() || distance.get<double>() > min_distance - 1e-6);
    }
    const std::string page = tests::read_content(folder_ / "teapot/compare/compare.html");
    EXPECT_THAT(page, HasSubstr("\"kind\":\"flown\""));
    EXPECT_THAT(page, HasSubstr("5 of 7 legs flown, 3 captures missed"));

    // Coverage of the flown poses, and of the flown poses with the patch mission.
    const Json& coverage = json["coverage"];
    EXPECT_NEAR(coverage["flown"]["coverage_visible"].get<double>(), truth, 0.01);
    EXPECT_LT(truth, whole - 0.05);
    const double closed = coverage["patched"]["coverage_visible"].get<double>() - truth;
    EXPECT_GT(closed, 0.95 * (whole - truth));

    // The patch mission is verified against the true scene.
    EXPECT_EQ(json["patch"]["waypoints"], 3);
    EXPECT_GE(json["patch"]["min_clearance_m"].get<double>(), 2.0);
    const tests::ProgramRun check =
        tests::run_skycap({"check", folder_ / "teapot.yaml", "--route",
                           folder_ / "teapot/compare/patch.plan", "--return-altitude", "17"});
    EXPECT_THAT(check.out, HasSubstr("patch.plan: verified, 0 of")) << check.err;
  }
}

TEST_F(FlightComparisonTest, ComparesAFlightInSeveralLogs) {
  // The battery was changed between stations 2 and 3.
  const auto half = static_cast<std::ptrdiff_t>((captures_.at(2) + captures_.at(3)) / 2);
  const std::vector<FlownState> first(flight_.begin(), flight_.begin() + half),
      second(flight_.begin() + half, flight_.end());
  const Json json = compare({folder_.write("1.bin", flight::write_dataflash(first, site, pad_)),
                             folder_.write("2.ulg", flight::write_ulog(second, site, pad_))},
                            0);
  EXPECT_EQ(json["captures"]["missed"], 0);
  EXPECT_EQ(json["log_kind"], "ArduPilot dataflash log, PX4 ULog");
}

/// One vehicle of a fleet is compared with its own files, and repeats its own missed views.
TEST(FleetComparison, ComparesOneVehicleAndPlansItsPatch) {
  const tests::TestFolder folder;
  std::string mission = tests::flight_mission();
  const std::string vehicle = "vehicle: generic,";
  mission.replace(mission.find(vehicle), vehicle.size(),
                  "vehicles: [generic, generic_ardupilot], separation: 6,");
  const tests::ProgramRun plan =
      tests::run_skycap({"plan", folder.write("m.yaml", mission), "--seed", "2", "--out",
                         folder / "m", "--no-report", "--quiet"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  const Json fleet = Json::parse(tests::read_content(folder / "m/summary.json"))["flight"]["fleet"];
  const Json& second = fleet["vehicles"][1];
  ASSERT_FALSE(second["order"].empty());

  // The vehicle rises above its take-off point and lands again.
  const Json& pad = second["pad"];
  std::vector<FlownState> flown;
  for (int i = 0; i < 40; ++i) {
    const double height = 0.5 * std::min(i, 40 - i);
    flown.push_back({{0.5 * i,
                      {pad[0].get<double>(), pad[1].get<double>(), pad[2].get<double>() + height},
                      0.0,
                      0.0,
                      0.0},
                     false});
  }
  const std::string log = folder.write(
      "second.bin", flight::write_dataflash(flown, site, flown.front().state.position));
  std::string route;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "m")) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("fleet-2") && name.ends_with(".waypoints")) route = entry.path().string();
  }
  ASSERT_FALSE(route.empty());
  const tests::ProgramRun run =
      tests::run_skycap({"compare", folder / "m", log, "--route", route, "--no-report"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const Json json = Json::parse(tests::read_content(folder / "m/compare/compare.json"));
  EXPECT_EQ(json["takeoff"], pad);
  EXPECT_EQ(json["captures"]["missed"], second["order"].size());
  EXPECT_EQ(json["patch"]["waypoints"], second["order"].size());
  EXPECT_GE(json["patch"]["min_clearance_m"].get<double>(), 2.0);
}

TEST_F(FlightComparisonTest, AssumesCapturesOfTracks) {
  const Json json = compare({folder_ / "teapot/mission.csv"}, 0);
  EXPECT_EQ(json["captures"]["source"], "log");
  std::string gpx = "<gpx><trk><trkseg>";
  const flight::LocalFrame frame(site.origin);
  for (const FlownState& flown : flight_) {
    const flight::GeodeticPoint point = frame.to_geodetic(flown.state.position);
    const double time = flown.state.time;
    char text[200];
    std::snprintf(text, sizeof text,
                  "<trkpt lat=\"%.9f\" lon=\"%.9f\"><ele>%.3f</ele>"
                  "<time>2026-05-01T10:%02d:%06.3fZ</time></trkpt>",
                  point.latitude_deg, point.longitude_deg, point.height - 48.0,
                  static_cast<int>(time / 60.0), std::fmod(time, 60.0));
    gpx += text;
  }
  const Json track = compare({folder_.write("a.gpx", gpx + "</trkseg></trk></gpx>")}, 0);
  EXPECT_EQ(track["captures"]["source"], "assumed");
  EXPECT_EQ(track["captures"]["missed"], 0);
}

TEST_F(FlightComparisonTest, NeedsNoPlan) {
  const std::string log = folder_.write("flown.bin", flight::write_dataflash(flight_, site, pad_));
  const auto compare_mission = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "compare", folder_ / "teapot.yaml",     log, "--out", folder_ / "flown",
        "--cloud", folder_ / "teapot/cloud.ply"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return tests::run_skycap(arguments);
  };
  const tests::ProgramRun run = compare_mission({});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(tests::read_content(folder_ / "flown/compare.json"));
  EXPECT_FALSE(json["has_plan"]);
  EXPECT_EQ(json["captures"]["other"], captures_.size());
  EXPECT_NEAR(json["coverage"]["flown"]["coverage_visible"].get<double>(), true_coverage(flight_),
              0.01);
  EXPECT_TRUE(json["coverage"]["planned"].is_null());

  const config::MissionSetup setup = package::read_package_summary(folder_ / "teapot", {}).mission;
  const geometry::MeshDistance model(evaluation::SurveyScene(setup.simulation, {}, 2).model());
  double nearest = 1e9;
  for (const FlownState& flown : flight_) {
    nearest = std::min(nearest, model.distance(flown.state.position));
  }
  EXPECT_NEAR(json["clearance"]["model"]["min_distance_m"].get<double>(), nearest, 0.1);
  EXPECT_GT(json["clearance"]["min_cloud_distance_m"].get<double>(), nearest - 0.1);
  EXPECT_THAT(run.out, HasSubstr("to the model"));
  EXPECT_THAT(compare_mission({"--route", folder_ / "teapot/mission.plan"}).err,
              HasSubstr("--route needs the results folder of a plan"));
}

TEST_F(FlightComparisonTest, RejectsLogsOfOtherPlaces) {
  const flight::Site elsewhere{{47.5, 8.2, 480.0}, 48.0};  // 44.5 km farther north
  const std::string log =
      folder_.write("flown.bin", flight::write_dataflash(flight_, elsewhere, pad_));
  for (const std::string& mission : {folder_ / "teapot", folder_ / "teapot.yaml"}) {
    const tests::ProgramRun run = tests::run_skycap({"compare", mission, log});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr("flown.bin: the flight stays 44."));
    EXPECT_THAT(run.err, HasSubstr(" km away from the mission"));
  }
}

TEST_F(FlightComparisonTest, RejectsOtherFiles) {
  const auto message = [&](const std::vector<std::string>& arguments) {
    return tests::run_skycap(arguments).err;
  };
  EXPECT_THAT(message({"compare", folder_.path().string(), folder_ / "none.bin"}),
              HasSubstr("summary.json"));
  EXPECT_THAT(message({"compare", folder_ / "teapot", folder_ / "none.bin"}),
              HasSubstr("none.bin"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "teapot/compare/compare.json"));
}

/// The flight of a photo mission is cut off after half of its photos.
TEST(PhotoComparison, StatesCompletenessAndClosesIt) {
  const tests::TestFolder folder;
  folder.write("box.obj",
               "v -4 -3 0\nv 4 -3 0\nv 4 3 0\nv -4 3 0\nv -4 -3 5\nv 4 -3 5\nv 4 3 5\nv -4 3 5\n"
               "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const std::string mission = folder.write(
      "box.yaml",
      "sensor: {photo_camera: mavic_3e_wide}\n"
      "photo: {gsd: 0.0026, patterns: []}\n"
      "prior: [{file: box.obj, role: target, uncertainty: 0.1}]\n"
      "limits: {stand_off: 3}\n"
      "site: {latitude_deg: 51.75, longitude_deg: -1.25, geoid_undulation: 47}\n"
      "flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}\n");
  const tests::ProgramRun plan =
      tests::run_skycap({"plan", mission, "--out", folder / "box", "--no-report"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  const Json summary = Json::parse(tests::read_content(folder / "box/summary.json"));
  const auto planned = summary["photo"]["figures"]["expected_completeness"].get<double>();

  const std::string track = tests::read_content(folder / "box/mission.csv");
  const auto compare = [&](const std::string& log) {
    tests::run_skycap({"compare", folder / "box", folder.write("log.csv", log)});
    return Json::parse(tests::read_content(folder / "box/compare/compare.json"));
  };
  const Json whole = compare(track);
  EXPECT_EQ(whole["captures"]["missed"], 0);
  EXPECT_NEAR(whole["photos"]["planned"]["expected_completeness"].get<double>(), planned, 0.002);
  EXPECT_NEAR(whole["photos"]["flown"]["expected_completeness"].get<double>(), planned, 0.002);
  EXPECT_TRUE(whole["photos"]["patched"].is_null());

  const Json half = compare(track.substr(0, track.find('\n', track.size() / 2) + 1));
  const Json& photos = half["photos"];
  EXPECT_GT(half["captures"]["missed"], 3);
  EXPECT_EQ(photos["flown"]["photos"].get<int>() + half["captures"]["missed"].get<int>(),
            photos["planned"]["photos"].get<int>());
  EXPECT_LT(photos["flown"]["expected_completeness"].get<double>(), planned - 0.1);
  EXPECT_NEAR(photos["patched"]["expected_completeness"].get<double>(), planned, 0.01);
}

}  // namespace
}  // namespace skycap::missions
