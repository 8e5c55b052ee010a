#include "missions/session/survey_flight.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/clearance/clearance.h"
#include "flight/export/export.h"
#include "flight/route/route.h"
#include "flight/rtl/returnable_space.h"
#include "missions/config/resolve.h"
#include "missions/package/package.h"
#include "missions/simulation/survey_runner.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using nlohmann::json;
using testing::EndsWith;
using testing::HasSubstr;
using tests::flight_mission;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

/// Returns all obstacles, observed or not.
flight::KnownSpace make_truth(const flight::FlightOptions& options,
                              const evaluation::SurveyScene& scene) {
  flight::Obstacles obstacles = options.rules();
  obstacles.mesh = scene.model();
  return flight::KnownSpace(obstacles);
}

// The planner and the flight only know measured space. The check uses the ground truth.
TEST(SurveyFlight, KeepsClearanceFromGroundTruth) {
  const config::MissionSetup mission = config::parse_mission(flight_mission(), "m.yaml");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const flight::KnownSpace truth = make_truth(mission.flight(), scene);
  for (const std::uint64_t seed : {1, 2}) {
    const session::SurveyRecord record = simulation::run_survey(mission.simulation, scene, seed, 1);
    ASSERT_TRUE(record.flight_record);
    ASSERT_EQ(record.flight_record->legs.size(), record.views.size());
    EXPECT_GT(record.views.size(), 4U);
    for (std::size_t i = 0; i < record.views.size(); ++i) {
      const session::ExecutedLeg& leg = record.flight_record->legs[i];
      EXPECT_EQ(leg.points.back(), record.views[i].surveyed.view.position);
      EXPECT_GE(leg.clearance, 2.0);
      EXPECT_TRUE(flight::check_route(leg.points, truth, 2.0).empty()) << "leg to view " << i;
      const Vector3d from =
          i > 0 ? record.views[i - 1].surveyed.view.position
                : record.flight_record->pad + Vector3d(0, 0, mission.flight().climb());
      EXPECT_EQ(leg.points.front(), from);
    }
    EXPECT_GE(record.flight_record->length(), record.distance());
  }
}

TEST(SurveyFlight, IsSameForAnyThreadCount) {
  const config::MissionSetup mission = config::parse_mission(flight_mission(), "m.yaml");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const session::SurveyRecord one = simulation::run_survey(mission.simulation, scene, 1, 1),
                              two = simulation::run_survey(mission.simulation, scene, 1, 2);
  EXPECT_EQ(package::views_csv(one), package::views_csv(two));
  EXPECT_EQ(one.flight_record->length(), two.flight_record->length());
  EXPECT_EQ(one.flight_record->measured->free_volume(), two.flight_record->measured->free_volume());
}

// Shipped missions with a vehicle, from any random start.
TEST(SurveyFlight, ReachesFirstViewOfShippedMissions) {
  const std::filesystem::path folder = std::filesystem::path(SKYCAP_SOURCE_DIR) / "missions";
  for (const char* name : {"radcliffe_camera.yaml", "city_block.yaml"}) {
    const config::MissionSetup mission =
        config::read_mission(folder / name, {{"--set", "evaluation.samples", "1000"}});
    ASSERT_TRUE(mission.flight().has_vehicle()) << name;
    const evaluation::SurveyScene scene(mission.simulation, folder, 0);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      EXPECT_NO_THROW(session::SurveyFlight(mission.flight(), scene.first_view(seed), 0))
          << name << " " << seed;
    }
  }
}

TEST(SurveyFlight, RespectsGimbalLimits) {
  const config::MissionSetup mission = config::parse_mission(flight_mission(), "m.yaml");
  const geometry::View first = geometry::look_at({-30, 0, 8}, {0, 0, 5});
  session::SurveyFlight flight(mission.flight(), first, 0);
  const Vector3d position(-30, 4, 8);
  EXPECT_TRUE(flight.can_reach(first.position, {position, Vector3d::UnitX()}));
  const double too_steep = mission.flight().required_vehicle().gimbal_max + 0.01;
  EXPECT_FALSE(flight.can_reach(first.position,
                                {position, Vector3d(std::cos(too_steep), 0, std::sin(too_steep))}));
}

TEST(SurveyFlight, StopsPathSearchOnRequest) {
  const config::MissionSetup mission = config::parse_mission(flight_mission(), "m.yaml");
  const geometry::View first = geometry::look_at({-30, 0, 8}, {0, 0, 5});
  session::SurveyFlight flight(mission.flight(), first, 0);
  std::stop_source stop;
  flight.stop_on(stop.get_token());
  const geometry::View next{{-30, 4, 8}, Vector3d::UnitX()};
  EXPECT_TRUE(flight.can_reach(first.position, next));
  stop.request_stop();
  EXPECT_THROW(flight.can_reach(first.position, next), survey::Interrupted);
}

/// Returns the package of one survey. All tests below only read it.
const TestFolder& package() {
  static const TestFolder folder;
  static const bool is_made = [] {
    const std::string mission = folder.write("m.yaml", flight_mission());
    const auto run = run_skycap({"plan", mission, "--out", folder / "out"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("verified for every leg; required 2.00 m"));
    // Not a format of this vehicle.
    EXPECT_FALSE(std::filesystem::exists(folder / "out/mission.kmz"));
    const auto dji = run_skycap({"export", folder / "out", "--format", "kmz"});
    EXPECT_EQ(dji.exit_code, 0) << dji.err;
    return true;
  }();
  EXPECT_TRUE(is_made);
  return folder;
}

TEST(FlightPackage, VerifiesEveryRouteFormatAgainstGroundTruth) {
  const TestFolder& folder = package();
  const json summary = json::parse(read_content(folder / "out/summary.json"));
  const json& flight = summary.at("flight");
  EXPECT_GE(summary.at("min_clearance_m").get<double>(), 2.0);
  EXPECT_EQ(summary.at("route_length_m"), flight.at("route").at("length_m"));
  EXPECT_GE(flight.at("route").at("order_length_m"), flight.at("route").at("order_bound_m"));
  double terms = 0.0;
  for (const char* term :
       {"vehicle_radius", "position_error", "tracking_error", "map_error", "margin"}) {
    terms += flight.at("clearance_m").at(term).get<double>();
  }
  EXPECT_NEAR(terms, 2.0, 1e-12);
  EXPECT_EQ(flight.at("route").at("stations").get<std::size_t>() +
                flight.at("route").at("skipped_views").size(),
            summary.at("views").get<std::size_t>());

  for (const char* extension : {"plan", "waypoints", "kmz", "kml", "geojson", "csv"}) {
    const std::string file = folder / ("out/mission." + std::string(extension));
    const auto check = run_skycap({"check", folder / "m.yaml", "--route", file});
    EXPECT_EQ(check.exit_code, 0) << extension << check.out << check.err;
    EXPECT_THAT(check.out, HasSubstr(": verified, 0 of "));
  }
}

// PX4 returns from random positions on the route, checked against the teapot's ground truth. Each
// return is sampled every 10 cm.
TEST(FlightPackage, KeepsReturnsClearOfGroundTruth) {
  const TestFolder& folder = package();
  const package::PackagedSurvey survey = package::read_package(folder / "out", {});
  const flight::Route route =
      package::plan_flight(survey.flight, survey.measured, survey.pad, survey.views, survey.paths);
  ASSERT_TRUE(route.returns);
  const json stated =
      json::parse(read_content(folder / "out/summary.json")).at("flight").at("return");
  EXPECT_EQ(stated.at("height_m").get<double>(), route.returns->height);
  EXPECT_EQ(stated.at("parameters"), json::array({"mission.params"}));

  const config::MissionSetup mission = config::read_mission(folder / "m.yaml");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const flight::KnownSpace truth = make_truth(survey.flight, scene);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const std::vector<Vector3d> points = flight::sortie_points(route, route.sorties.at(0));
  const double level = survey.pad.z() + route.returns->height;
  for (int i = 0; i < 1000; ++i) {
    const std::size_t leg = 1 + random() % (points.size() - 1);
    const Vector3d from = flight::Segment{points[leg - 1], points[leg]}.at(share(random));
    // PX4 starts level flight up to 0.8 m below the return altitude.
    const double top = std::max(from.z(), level - 0.8 * share(random));
    const Vector3d above(from.x(), from.y(), top), home(survey.pad.x(), survey.pad.y(), top);
    for (const flight::Segment& segment : {flight::Segment{from, above}, {above, home}}) {
      const int steps = 1 + static_cast<int>(segment.length() / 0.1);
      for (int step = 0; step <= steps; ++step) {
        const Vector3d position = segment.at(static_cast<double>(step) / steps);
        ASSERT_GE(truth.distance(position, 3.0), route.returns->clearance - 1e-6)
            << position.transpose() << " from " << from.transpose();
      }
    }
  }
}

TEST(FlightPackage, VerifiesReturnsAtStatedAltitude) {
  const TestFolder& folder = package();
  const auto check = [&](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"check", folder / "m.yaml", "--route", file};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_skycap(arguments);
  };
  EXPECT_THAT(check(folder / "out/mission.plan", {}).out, HasSubstr("(mission.params)"));
  EXPECT_THAT(check(folder / "out/mission.kmz", {}).out, HasSubstr("(globalRTHHeight)"));
  EXPECT_THAT(check(folder / "out/mission.csv", {}).out, HasSubstr("returns not checked"));

  // The file itself contains no return settings. With other parameters, those are used.
  const TestFolder alone;
  const std::string plan = alone.write("mission.plan", read_content(folder / "out/mission.plan"));
  const auto unsaid = check(plan, {});
  EXPECT_EQ(unsaid.exit_code, 0);
  EXPECT_THAT(unsaid.out, HasSubstr("does not contain the vehicle's return altitude: set it to "));
  alone.write("mission.params", "1\t1\tRTL_RETURN_ALT\t40\t9\n");
  const auto cone = check(plan, {});
  EXPECT_EQ(cone.exit_code, 1);
  EXPECT_THAT(cone.out,
              HasSubstr("not verified: mission.params: RTL_CONE_ANG is 45; it must be 0"));
}

TEST(FlightPackage, ReportsCollidingLegsInMovedScene) {
  const TestFolder& folder = package();
  // The same route, with the teapot moved to its lowest capture point.
  const std::vector<geometry::View> views = package::read_package(folder / "out", {}).views;
  const Vector3d at = std::ranges::min(views, {}, [](const geometry::View& view) {
                        return view.position.z();
                      }).position;
  const std::string position = std::to_string(at.x()) + ", " + std::to_string(at.y());
  const auto run = run_skycap({"check", folder / "m.yaml", "--route", folder / "out/mission.plan",
                               "--set", "scene.position=[" + position + ", 0]"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("mission.plan: leg "));
  EXPECT_THAT(run.out, HasSubstr(" of the scene at ("));
  EXPECT_THAT(run.out, HasSubstr(": not verified, "));
}

// Within its package, a file is checked against the package's pad. Items are numbered as in the
// ground station.
TEST(FlightPackage, NamesItemsOfCorruptedFiles) {
  const TestFolder& folder = package();
  json plan = json::parse(read_content(folder / "out/mission.plan"));
  const auto check = [&](const json& corrupted) {
    std::filesystem::create_directory(folder / "spoiled");
    std::filesystem::copy_file(folder / "out/summary.json", folder / "spoiled/summary.json",
                               std::filesystem::copy_options::overwrite_existing);
    folder.write("spoiled/mission.plan", corrupted.dump());
    return run_skycap({"check", folder / "m.yaml", "--route", folder / "spoiled/mission.plan"});
  };
  EXPECT_EQ(check(plan).exit_code, 0);
  json moved = plan;
  moved["mission"]["plannedHomePosition"][2] =
      moved["mission"]["plannedHomePosition"][2].get<double>() + 30.0;
  EXPECT_EQ(check(moved).exit_code, 1);
  EXPECT_THAT(check(moved).out,
              HasSubstr("mission.plannedHomePosition is 30.0 m above the take-off point"));
  json skipping = plan;
  const std::size_t last = skipping["mission"]["items"].size() - 2;
  skipping["mission"]["items"][last]["command"] = 82;
  EXPECT_EQ(check(skipping).exit_code, 1);
  EXPECT_THAT(check(skipping).out, HasSubstr("mission.plan: item " + std::to_string(last + 1) +
                                             " (command 82) is a NAV_SPLINE_WAYPOINT"));
}

TEST(FlightPackage, ExportsForAnotherVehicle) {
  const TestFolder& folder = package();
  const auto run = run_skycap({"export", folder / "out", "--format", "kmz", "--format", "litchi",
                               "--set", "flight.vehicle=mavic_3e", "--out", folder / "again"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("mavic_3e, "));
  EXPECT_FALSE(std::filesystem::exists(folder / "again/mission.plan"));
  for (const char* file : {"again/mission.kmz", "again/mission.litchi.csv"}) {
    EXPECT_EQ(run_skycap({"check", folder / "m.yaml", "--route", folder / file}).exit_code, 0);
  }
}

/// Returns the steps that the export prints for the pilot of this vehicle.
std::string steps_for(const std::string& vehicle, const std::string& format) {
  const TestFolder& folder = package();
  const TestFolder out;
  const auto run = run_skycap({"export", folder / "out", "--format", format, "--set",
                               "flight.vehicle=" + vehicle, "--out", out / "own"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const std::size_t steps = run.out.find("Before the flight (" + vehicle + "):\n  1. ");
  EXPECT_NE(steps, std::string::npos) << run.out;
  return steps == std::string::npos ? "" : run.out.substr(steps);
}

TEST(FlightPackage, PrintsStepsForConfiguredVehicleOnly) {
  const std::vector<std::string> ardupilot{"RTL_ALT ", "RTL_CONE_SLOPE", "BATT_LOW_MAH",
                                           "mission.param "},
      px4{"RTL_RETURN_ALT", "RTL_CONE_ANG", "mission.params ", "mission.plan in QGroundControl"},
      dji{"DJI Pilot 2", "RTH altitude to ", "RTH mode", "mission.kmz"};
  const auto expect_only = [](const std::string& text, const std::vector<std::string>& own,
                              const std::vector<std::vector<std::string>>& others) {
    for (const std::string& step : own) EXPECT_THAT(text, HasSubstr(step));
    for (const std::vector<std::string>& other : others) {
      for (const std::string& step : other) EXPECT_THAT(text, testing::Not(HasSubstr(step)));
    }
    EXPECT_THAT(text, HasSubstr("verified from every point of the route, at this altitude only"));
    EXPECT_THAT(text, HasSubstr("Take off at latitude "));
    EXPECT_THAT(text, HasSubstr("\nNot verified; the pilot must check: "));
    const std::string warning =
        "\nWarning: slope of the take-off pad is unknown. Inspect the pad and set "
        "flight.pad_slope_deg.\n";
    EXPECT_THAT(text, HasSubstr(warning));
    EXPECT_LT(text.find("\nNot verified"), text.find("\nWarning: "));  // warnings are last
  };
  expect_only(steps_for("generic_ardupilot", "waypoints"), ardupilot, {px4, dji});
  expect_only(steps_for("generic", "plan"), px4, {ardupilot, dji});
  expect_only(steps_for("mavic_3e", "kmz"), dji, {ardupilot, px4});
}

TEST(FlightPackage, ReadsBackAsPlanned) {
  const TestFolder& folder = package();
  const package::PackagedSurvey survey = package::read_package(folder / "out", {});
  const config::MissionSetup mission = config::read_mission(folder / "m.yaml");
  EXPECT_EQ(survey.flight.clearance, mission.flight().clearance);
  EXPECT_EQ(survey.flight.capture.view_distance, mission.flight().capture.view_distance);
  const json summary = json::parse(read_content(folder / "out/summary.json"));
  EXPECT_EQ(survey.views.size(), summary.at("views").get<std::size_t>());
  const flight::Route route =
      package::plan_flight(survey.flight, survey.measured, survey.pad, survey.views, survey.paths);
  EXPECT_EQ(route.length, summary.at("route_length_m").get<double>());
}

// In survey order, the route contains only legs that the survey flew. Exceptions are the return and
// replacements of legs without verified returns.
TEST(FlightPackage, KeepsSurveyPathsInSurveyOrder) {
  const TestFolder& folder = package();
  const package::PackagedSurvey survey =
      package::read_package(folder / "out", {{"--set", "flight.order", "survey"}});
  const flight::Route route =
      package::plan_flight(survey.flight, survey.measured, survey.pad, survey.views, survey.paths);
  ASSERT_EQ(route.sorties.size(), 1U);
  ASSERT_EQ(route.capture_points.size(), survey.views.size());
  EXPECT_EQ(route.sorties[0].out.points, survey.paths[0]);
  const flight::KnownSpace rules(survey.flight.rules());
  const flight::JointSpace space({&survey.measured, &rules});
  double top = survey.pad.z() + route.options.takeoff_climb;
  for (const geometry::View& view : survey.views) top = std::max(top, view.position.z());
  const flight::ReturnableSpace returnable(space, planning_rtl_profile(route.options, top));
  ASSERT_FALSE(route.legs.empty());
  for (std::size_t i = 0; i < route.legs.size(); ++i) {
    EXPECT_EQ(route.capture_points[i + 1].view_index, i + 1);
    EXPECT_EQ(route.legs[i].points.front(), survey.paths[i + 1].front()) << i;
    EXPECT_EQ(route.legs[i].points.back(), survey.paths[i + 1].back()) << i;
    EXPECT_EQ(route.legs[i].points == survey.paths[i + 1],
              returnable.has_returns(survey.paths[i + 1], route.clearance))
        << i;
  }
}

TEST(FlightPackage, RejectsSummaryPathsOutOfRange) {
  const TestFolder& folder = package();
  json summary = json::parse(read_content(folder / "out/summary.json"));
  summary["per_view"][1]["way"][0][2] = 1e300;
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { package::parse_package_summary(summary.dump(), "summary.json"); }),
              HasSubstr("summary.json: per_view[1].way"));
}

TEST(FlightPackage, WritesFilePerSortieForSmallBattery) {
  const TestFolder& folder = package();
  const auto run = run_skycap({"export", folder / "out", "--format", "plan", "--set",
                               "flight.hold=300", "--out", folder / "sorties"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "sorties/mission-1.plan"));
  EXPECT_TRUE(std::filesystem::exists(folder / "sorties/mission-2.plan"));
  // After another export with full batteries, the files of the previous split are removed.
  EXPECT_EQ(run_skycap({"export", folder / "out", "--format", "plan", "--out", folder / "sorties"})
                .exit_code,
            0);
  EXPECT_TRUE(std::filesystem::exists(folder / "sorties/mission.plan"));
  EXPECT_FALSE(std::filesystem::exists(folder / "sorties/mission-1.plan"));
}

TEST(FlightPackage, ReportsMissingDataOfFormats) {
  const TestFolder folder;
  std::string text = flight_mission();
  text.erase(text.find("site:"), text.find("evaluation:") - text.find("site:"));
  const std::string mission = folder.write("m.yaml", text);
  const auto run = run_skycap({"plan", mission, "--out", folder / "out", "--max-views", "3"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("no mission.plan: requires a georeference"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/mission.csv"));

  const auto alone = run_skycap({"export", folder / "out", "--format", "plan", "--set",
                                 "site.latitude_deg=1", "--set", "site.longitude_deg=2"});
  EXPECT_EQ(alone.exit_code, 0) << alone.err;  // AMSL, from EGM96
}

// The space above the pad is assumed free, but the tip of the spout is there.
TEST(FlightPackage, KeepsSurveyWithoutRoute) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", flight_mission());
  const auto plan = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"plan",        mission,
                                          "--out",       folder / out,
                                          "--max-views", "4",
                                          "--set",       "flight.unknown_box.max=[9.3, 11, 13]",
                                          "--set",       "flight.takeoff=[11.6, 0, 0]",
                                          "--set",       "flight.takeoff_climb=7.4",
                                          "--set",       "start.position=[32, 0, 8]",
                                          "--set",       "start.look_at=[0, 0, 5]"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_skycap(arguments);
  };
  const auto quiet = plan("quiet", {"--quiet"});
  EXPECT_EQ(quiet.exit_code, 1);
  EXPECT_EQ(quiet.out, "");
  EXPECT_THAT(quiet.err, HasSubstr("m.yaml: no route: the end of the take-off climb"));
  const auto run = plan("out", {});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.out, HasSubstr("flight    none: the end of the take-off climb"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/cloud.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/mission.plan"));
  const json summary = json::parse(read_content(folder / "out/summary.json"));
  EXPECT_THAT(summary.at("flight").at("failure").get<std::string>(), HasSubstr("a measured point"));
  // From another pad there is a route.
  EXPECT_EQ(run_skycap({"export", folder / "out", "--format", "plan", "--set",
                        "flight.takeoff=[-30, 0, 0]"})
                .exit_code,
            0);
}

TEST(FlightPackage, ReportsDamagedPackagesAndRoutes) {
  const TestFolder& folder = package();
  const auto message = [](const std::vector<std::string>& arguments) {
    const auto run = run_skycap(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1);
    return run.err;
  };
  EXPECT_THAT(message({"export", folder / "nowhere", "--format", "kml"}),
              HasSubstr("summary.json: does not exist"));
  EXPECT_THAT(message({"export", folder / "out", "--format", "pdf"}),
              HasSubstr("unknown format \"pdf\"; expected one of: plan, "));
  const TestFolder broken;
  broken.write("summary.json", "{\"mission\": 3");
  EXPECT_THAT(message({"export", broken.path().string(), "--format", "kml"}),
              HasSubstr("summary.json: is not the summary of a package"));
  broken.write("summary.json", read_content(folder / "out/summary.json"));
  EXPECT_THAT(message({"export", broken.path().string(), "--format", "kml"}),
              HasSubstr("free_space.bin: cannot be read; plan the mission again"));
  broken.write("free_space.bin", "skycap free v1");
  EXPECT_THAT(message({"export", broken.path().string(), "--format", "kml"}),
              HasSubstr("free_space.bin: is not a free-space file"));
  EXPECT_THAT(message({"check", folder / "m.yaml", "--route", folder / "out/cloud.ply"}),
              HasSubstr("cloud.ply is not a route file: its name must end in .plan"));
  EXPECT_THAT(message({"check", folder / "m.yaml", "--route", folder / "no.plan"}),
              HasSubstr("no.plan: does not exist"));
}

}  // namespace
}  // namespace skycap::missions
