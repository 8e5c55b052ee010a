// Own routes: verified round a box, rejected through it, repaired, exported and checked again.
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/clearance/clearance.h"
#include "flight/export/export.h"
#include "flight/export/geodesy.h"
#include "geometry/io/mesh_io.h"
#include "geometry/text_parts.h"
#include "missions/package/profile_file.h"
#include "sim/models/masonry/solids.h"
#include "tests/flight/flown/flown_logs.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const flight::Site site{{47.1, 8.2, 480.0}, 48.0};
const Vector3d pad(-75, 0, 0);

/// Square at 12 m from the walls of a house of 20 x 20 x 15 m around the origin.
const std::vector<Vector3d> square{
    {-22, -22, 10}, {22, -22, 10}, {22, 22, 10}, {-22, 22, 10}, {-22, -22, 10}};
/// Its third leg goes through the house.
const std::vector<Vector3d> through{
    {-22, -22, 10}, {22, -22, 10}, {22, 0, 10}, {-22, 0, 10}, {-22, -22, 10}};

class OwnRouteTest : public testing::Test {
 protected:
  OwnRouteTest() {
    geometry::write_mesh(folder_ / "house.obj", sim::models::box({-10, -10, 0}, {10, 10, 15}));
    mission_ = folder_.write("house.yaml",
                             "scene: {model: house.obj}\n"
                             "planner: {name: skycap, density: 1, view_distance: 12}\n"
                             "flight: {vehicle: generic, takeoff: [-75, 0, 0],\n"
                             "         unknown_box: {min: [-12, -12, 0], max: [12, 12, 17]}}\n"
                             "site: {latitude_deg: 47.1, longitude_deg: 8.2,\n"
                             "       ellipsoid_height: 480, geoid_undulation: 48}\n"
                             "evaluation: {coverage_distance: 0.6}\n");
  }

  /// Writes a waypoint table with a photo at each waypoint.
  std::string table(const std::vector<Vector3d>& positions,
                    const std::string& name = "route.csv") const {
    const flight::LocalFrame frame(site.origin);
    std::string text = "lat,lon,height,heading,gimbal_pitch,photo\n";
    for (const Vector3d& position : positions) {
      const flight::GeodeticPoint point = frame.to_geodetic(position);
      text += fmt::format("{:.9f},{:.9f},{:.4f},{},-20,1\n", point.latitude_deg,
                          point.longitude_deg, point.height - frame.to_geodetic(pad).height, 45);
    }
    return folder_.write(name, text);
  }

  tests::ProgramRun export_route(const std::string& route,
                                 std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"export", mission_, "--route",
                                       route,    "--out",  folder_ / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return tests::run_skycap(arguments);
  }

  std::vector<Vector3d> positions(const std::string& file) const {
    return flight::read_route(folder_.path() / "out" / file, site, pad);
  }

  /// Returns true if the written route passes within 0.1 m of a position.
  bool passes(const std::string& file, const Vector3d& position) const {
    for (const Vector3d& point : positions(file)) {
      if ((point - position).norm() < 0.1) return true;
    }
    return false;
  }

  tests::TestFolder folder_;
  std::string mission_;
};

TEST_F(OwnRouteTest, ExportsARouteRoundTheHouse) {
  const tests::ProgramRun run = export_route(table(square));
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("house: verified"), HasSubstr("waypoint table, 5 positions"),
                             HasSubstr("heights above take-off"), Not(HasSubstr("repaired"))));
  for (const char* file : {"mission.plan", "mission.waypoints", "mission.kml", "mission.geojson",
                           "mission.csv", "profile.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out" / file)) << file;
  }
  for (const Vector3d& corner : square) EXPECT_TRUE(passes("mission.plan", corner));
  // The written files pass the independent check against the scene.
  for (const char* file : {"mission.plan", "mission.waypoints", "mission.csv"}) {
    const tests::ProgramRun check =
        tests::run_skycap({"check", mission_, "--route", folder_ / (std::string("out/") + file)});
    EXPECT_EQ(check.exit_code, 0) << file << check.out << check.err;
  }
}

TEST_F(OwnRouteTest, RejectsARouteThroughTheHouseWithItsLeg) {
  const tests::ProgramRun run = export_route(table(through));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("leg 3 (line 4 to line 5): 0.000 m from triangle"),
                             HasSubstr("1 of 4 legs violate the clearance of 2 m"),
                             HasSubstr("use --repair")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
}

TEST_F(OwnRouteTest, RepairsARouteThroughTheHouse) {
  const tests::ProgramRun run = export_route(table(through), {"--repair"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  std::smatch found;
  ASSERT_TRUE(std::regex_search(run.out, found,
                                std::regex("repaired  leg from line 4 to line 5: ([0-9.]+) m "
                                           "instead of 44.0 m")))
      << run.out;
  // Over the house at 17 m or round it at 12 m from its centre.
  EXPECT_GT(std::stod(found[1]), 46.0);
  EXPECT_LT(std::stod(found[1]), 90.0);
  for (const Vector3d& corner : through) EXPECT_TRUE(passes("mission.plan", corner));
  const flight::KnownSpace house([] {
    flight::Obstacles obstacles;
    obstacles.mesh = sim::models::box({-10, -10, 0}, {10, 10, 15});
    return obstacles;
  }());
  const std::vector<Vector3d> flown = positions("mission.plan");
  for (std::size_t i = 1; i < flown.size(); ++i) {
    EXPECT_TRUE(verify(house, {flown[i - 1], flown[i]}, 1.98).is_verified) << i;
  }
}

TEST_F(OwnRouteTest, SkipsWaypointsInsideTheHouseOnlyIfRepaired) {
  std::vector<Vector3d> inside = square;
  inside.insert(inside.begin() + 2, Vector3d(0, 0, 10));
  EXPECT_EQ(export_route(table(inside)).exit_code, 1);
  const tests::ProgramRun run = export_route(table(inside), {"--repair"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("skipped   waypoint line 4: it is 0.000 m from"));
}

TEST_F(OwnRouteTest, KeepsGeofenceAndNoFlyVolumes) {
  const std::string route = table(square);
  const auto reject = [&](const std::string& setting) {
    const tests::ProgramRun run = export_route(route, {"--set", setting});
    EXPECT_EQ(run.exit_code, 1) << run.err;
    return run.out;
  };
  EXPECT_THAT(
      reject("site.no_fly=[{corners: [[20, -2], [24, -2], [24, 2], [20, 2]], floor: 0, "
             "ceiling: 30}]"),
      AllOf(HasSubstr("leg 2 (line 3 to line 4)"), HasSubstr("no-fly"), HasSubstr("1 of 4 legs")));
  // The third leg is 1 m inside.
  EXPECT_THAT(reject("site.geofence=[[-90, -90], [90, -90], [90, 23], [-90, 23]]"),
              AllOf(HasSubstr("leg 3 (line 4 to line 5): 1.000 m from"), HasSubstr("geofence")));
}

TEST_F(OwnRouteTest, SimplifiesAFlownLog) {
  std::vector<Vector3d> flown{pad, pad + Vector3d(0, 0, 10)};
  flown.insert(flown.end(), square.begin(), square.end());
  flown.emplace_back(pad + Vector3d(0, 0, 10));
  flown.push_back(pad);
  const std::string log = flight::write_dataflash(flight::fly_polyline(flown, {3, 4}), site, pad);
  const tests::ProgramRun run =
      export_route(folder_.write("flight.bin", log), {"--simplify", "0.4"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("simplified to "), HasSubstr("at most 0.4 m allowed"),
                             HasSubstr("at the take-off point replaced by the climb")));
  EXPECT_TRUE(passes("mission.plan", square[1]));
  EXPECT_TRUE(passes("mission.plan", square[2]));
  // The log has some hundred positions.
  EXPECT_LT(positions("mission.plan").size(), 25U);
}

TEST_F(OwnRouteTest, ReadsItsOwnFilesAgain) {
  ASSERT_EQ(export_route(table(square)).exit_code, 0);
  for (const char* file : {"mission.plan", "mission.waypoints", "mission.kml"}) {
    const std::string copy =
        folder_.write(std::string("again") + std::filesystem::path(file).extension().string(),
                      tests::read_content(folder_.path() / "out" / file));
    const tests::ProgramRun run = tests::run_skycap(
        {"export", mission_, "--route", copy, "--out", folder_ / "again", "--format", "csv"});
    EXPECT_EQ(run.exit_code, 0) << file << run.out << run.err;
    EXPECT_THAT(run.out, Not(HasSubstr("repaired"))) << file;
    const std::vector<Vector3d> flown =
        flight::read_route(folder_.path() / "again/mission.csv", site, pad);
    for (const Vector3d& corner : square) {
      EXPECT_TRUE(std::ranges::any_of(flown, [&](const Vector3d& point) {
        return (point - corner).norm() < 0.05;
      })) << file;
    }
  }
}

/// The views of a survey are often at the required clearance, to which files round.
TEST(OwnRoute, VerifiesTheFilesOfAPlanInTheMeasuredSpace) {
  const tests::TestFolder folder;
  const std::string mission = folder.write("m.yaml", tests::flight_mission());
  for (const std::string seed : {"1", "3"}) {
    const std::string plan = folder / seed;
    ASSERT_EQ(tests::run_skycap({"plan", mission, "--seed", seed, "--out", plan, "--no-report"})
                  .exit_code,
              0);
    for (const char* file :
         {"mission.plan", "mission.waypoints", "mission.kml", "mission.geojson", "mission.csv"}) {
      const tests::ProgramRun run = tests::run_skycap(
          {"export", plan, "--route", plan + "/" + file, "--out", folder / "again"});
      EXPECT_EQ(run.exit_code, 0) << "seed " << seed << ", " << file << ": " << run.out << run.err;
    }
  }
}

TEST_F(OwnRouteTest, StatesTheMinimumClearanceInTheProfile) {
  const tests::ProgramRun run = export_route(table(square));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const auto rows = package::read_profile(tests::read_content(folder_.path() / "out/profile.csv"));
  double least = 1e9, end = 0.0;
  for (const package::ProfileRow& row : rows) {
    EXPECT_NEAR(row.begin, end, 1e-3);
    end = row.end;
    if (row.part != "leg") {
      EXPECT_EQ(row.kind, "not verified");
      continue;
    }
    least = std::min(least, row.clearance);
    EXPECT_EQ(row.ground, 0.0);
    EXPECT_FALSE(row.is_terrain);
    EXPECT_EQ(row.required, 2.0);
  }
  std::smatch found;
  ASSERT_TRUE(std::regex_search(run.out, found, std::regex("clearance minimum ([0-9.]+) m")));
  EXPECT_NEAR(least, std::stod(found[1]), 0.006);
  EXPECT_LE(least, std::stod(found[1]) + 0.005);
}

TEST_F(OwnRouteTest, DividesMissionsOfConsumerDrones) {
  std::vector<Vector3d> ring;
  constexpr int count = 150;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    ring.emplace_back(40.0 * std::cos(angle), 40.0 * std::sin(angle), 20.0);
  }
  const tests::ProgramRun run =
      export_route(table(ring), {"--set", "flight.vehicle=air_2s", "--set", "flight.clearance=4",
                                 "--set", "flight.takeoff=[-120, 0, 0]"});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("of at most 99 per file (Litchi), one per photo"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out/mission.kmz"));
  std::size_t photos = 0, files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "out")) {
    if (!entry.path().string().ends_with(".litchi.csv")) continue;
    ++files;
    const auto lines = flight::split_lines(tests::read_content(entry.path()));
    EXPECT_LE(lines.size(), 100U);  // header and 99 waypoints
    const tests::ProgramRun check = tests::run_skycap(
        {"check", mission_, "--route", entry.path().string(), "--set", "flight.vehicle=air_2s",
         "--set", "flight.clearance=4", "--set", "flight.takeoff=[-120, 0, 0]"});
    EXPECT_THAT(check.out, HasSubstr(": verified")) << check.out << check.err;
    for (const std::string& line : lines) photos += line.find(",1,0,") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(files, 2U);
  EXPECT_EQ(photos, static_cast<std::size_t>(count));
}

/// Returns the rows of the profile in a folder.
std::vector<package::ProfileRow> read_rows(const std::filesystem::path& folder) {
  return package::read_profile(tests::read_content(folder / "profile.csv"));
}

TEST(SurveyProfile, StatesTheClearanceOfTheSummaryAndUnknownSpace) {
  const tests::TestFolder folder;
  const std::string mission = folder.write("teapot.yaml", tests::flight_mission());
  const tests::ProgramRun plan = tests::run_skycap(
      {"plan", mission, "--out", folder / "teapot", "--set", "flight.vehicle=mini_2", "--set",
       "flight.clearance=3.5", "--set", "flight.takeoff=[-75, 0, 0]"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  const nlohmann::json summary =
      nlohmann::json::parse(tests::read_content(folder.path() / "teapot/summary.json"));
  const nlohmann::json& flight = summary.at("flight");
  double least = 1e9;
  for (const package::ProfileRow& row : read_rows(folder.path() / "teapot")) {
    if (row.part == "leg") least = std::min(least, row.clearance);
  }
  const double stated = summary.at("min_clearance_m");
  EXPECT_LE(least, stated);
  EXPECT_NEAR(least, stated, 0.0011);

  EXPECT_EQ(flight.at("waypoint_limit").at("app"), "Litchi");
  EXPECT_EQ(flight.at("waypoint_limit").at("max_waypoints"), 99);
  for (const nlohmann::json& sortie : flight.at("route").at("sorties")) {
    EXPECT_LE(sortie.at("waypoints").get<int>(), 99);
  }
  EXPECT_THAT(tests::read_content(folder.path() / "teapot/report.html"), HasSubstr("\"profile\""));

  // The survey has not measured the inside of the teapot, nor all space in the unknown box.
  const flight::LocalFrame frame(site.origin);
  std::string table = "lat,lon,altitude\n";
  for (const Vector3d& position : {Vector3d(-40, 0, 8), Vector3d(40, 0, 8)}) {
    const flight::GeodeticPoint point = frame.to_geodetic(position);
    table += fmt::format("{:.9f},{:.9f},{:.4f}\n", point.latitude_deg, point.longitude_deg,
                         point.height - 48.0);
  }
  const std::string route = folder.write("through.csv", table);
  const std::vector<std::string> arguments{"export", folder / "teapot", "--route",
                                           route,    "--out",           folder / "own"};
  const tests::ProgramRun rejected = tests::run_skycap(arguments);
  EXPECT_EQ(rejected.exit_code, 1) << rejected.err;
  EXPECT_THAT(rejected.out, HasSubstr("leg 1 (line 2 to line 3): 0.000 m from"));
  std::vector<std::string> repairing = arguments;
  repairing.emplace_back("--repair");
  const tests::ProgramRun repaired = tests::run_skycap(repairing);
  EXPECT_EQ(repaired.exit_code, 0) << repaired.out << repaired.err;
  EXPECT_THAT(repaired.out, AllOf(HasSubstr("heights above mean sea level"),
                                  HasSubstr("repaired  leg from line 2 to line 3")));
  bool has_unknown = false;
  for (const package::ProfileRow& row : read_rows(folder.path() / "own")) {
    has_unknown = has_unknown || row.kind == "unknown";
  }
  EXPECT_TRUE(has_unknown);
}

TEST_F(OwnRouteTest, RejectsInvalidUse) {
  const std::string route = table(square);
  const auto error_of = [&](const std::vector<std::string>& arguments) {
    const tests::ProgramRun run = tests::run_skycap(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    return run.err;
  };
  EXPECT_THAT(error_of({"export", mission_, "--route", route}),
              HasSubstr("--route requires --out"));
  EXPECT_THAT(error_of({"export", mission_, "--repair", "--format", "kmz"}),
              HasSubstr("require --route"));
  EXPECT_THAT(error_of({"export", mission_}), HasSubstr("--format is required"));
  EXPECT_THAT(
      error_of({"export", mission_, "--route", folder_ / "none.csv", "--out", folder_ / "out"}),
      HasSubstr("none.csv"));
  EXPECT_THAT(error_of({"export", mission_, "--route", route, "--out", folder_ / "out", "--set",
                        "flight.takeoff=none"}),
              HasSubstr("takeoff"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
}

}  // namespace
}  // namespace skycap::missions
