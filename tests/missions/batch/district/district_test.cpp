// From one map to surveys of its buildings and one verified flight for all of them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/batch/district/preparation.h"
#include "missions/config/resolve.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/site_data/cube_files.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::Cube;
using tests::read_content;

/// Returns a CityJSON map with 10 m buildings in UTM 32. Their bases are at 380 m plus the z
/// offset.
std::string town(const std::vector<Vector3d>& positions) {
  json town = {{"type", "CityJSON"},
               {"version", "1.0"},
               {"metadata", {{"referenceSystem", "EPSG:25832"}}},
               {"CityObjects", json::object()},
               {"vertices", json::array()}};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Cube cube;
    cube.low += positions[i];
    const std::size_t first = town["vertices"].size();
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d location = cube.corner(corner);
      town["vertices"].push_back({location.x(), location.y(), location.z()});
    }
    json faces = json::array();
    for (const auto& face : Cube::faces) {
      json ring = json::array();
      for (const int corner : face) ring.push_back(first + static_cast<std::size_t>(corner));
      faces.push_back(json::array({ring}));
    }
    town["CityObjects"]["house_" + std::to_string(i)] = {
        {"type", "Building"},
        {"attributes", {{"number", std::to_string(i)}}},
        {"geometry", {{{"type", "MultiSurface"}, {"lod", "2"}, {"boundaries", std::move(faces)}}}}};
  }
  return town.dump();
}

/// Two buildings that share a wall, a detached one, and one that is not a target.
const std::vector<Vector3d> positions{{0, 0, 0}, {10, 0, 0}, {60, 0, 0}, {60, 30, 0}};

constexpr const char* few_views =
    "set: {limits.max_views: 3, flight.views: survey, evaluation: {samples: 2000, "
    "visible_directions: 20, attainable_views: 0}}\n";

class District : public testing::Test {
 protected:
  District() {
    folder_.write("town.city.json", town(positions));
    write("map: town.city.json\nvertical: ellipsoid\ntargets: {id: [house_0, house_1, house_2]}\n");
  }

  void write(const std::string& text) const { folder_.write("quarter.yaml", text + few_views); }
  tests::ProgramRun run(const std::vector<std::string>& more = {}, int threads = 1) const {
    std::vector<std::string> words{"district",  folder_ / "quarter.yaml", "--out", folder_ / "out",
                                   "--threads", std::to_string(threads)};
    words.insert(words.end(), more.begin(), more.end());
    return tests::run_skycap(words);
  }
  json results() const { return json::parse(read_content(out() / "district.json")); }
  fs::path out() const { return folder_.path() / "out"; }

  const tests::TestFolder folder_;
};

TEST_F(District, PlansSurveysAndFlightWithOneCommand) {
  const auto run_once = run();
  ASSERT_EQ(run_once.exit_code, 0) << run_once.err << run_once.out;
  EXPECT_THAT(run_once.out, HasSubstr("2 of 2 surveyed"));
  const json all = results();
  ASSERT_EQ(all.at("targets").size(), 2U);
  EXPECT_THAT(all["targets"][0].at("ids"), ElementsAre("house_0", "house_1"));
  EXPECT_EQ(all["targets"][0].at("title"), "house_0_and_1");
  for (const json& target : all["targets"]) {
    EXPECT_GT(target.at("survey").at("coverage").get<double>(), 0.3);
    const fs::path package = out() / target["survey"].at("folder").get<std::string>();
    EXPECT_TRUE(fs::exists(package / "report.html"));
    EXPECT_EQ(target.at("views_flown"), target["survey"].at("views")) << target.at("why_not_flown");
  }
  EXPECT_EQ(all.at("neighbours").size(), 1U);
  const json& flight = all.at("flight");
  EXPECT_GE(flight.at("min_clearance_m").get<double>(), 2.0);
  EXPECT_GE(flight.at("sorties").get<int>(), 1);
  EXPECT_THAT(read_content(out() / "district.html"),
              AllOf(HasSubstr("quarter"), HasSubstr("house_2")));
  EXPECT_THAT(read_content(out() / "targets.csv"), HasSubstr("house_0_and_1,2,3,"));
}

// Checks the file as an autopilot reads it against the ground truth: all buildings and the ground.
TEST_F(District, VerifiesRouteFilesAgainstAllBuildings) {
  ASSERT_EQ(run({"--no-report"}).exit_code, 0);
  const json flight = results().at("flight");
  int checked = 0;
  for (const json& pad : flight.at("pads")) {
    const std::string mission =
        out() / batch::flights_folder / (batch::pad_name(pad.at("pad")) + ".yaml");
    for (const json& file : pad.at("files")) {
      const std::string name = file.at("name");
      if (!name.ends_with(".plan") && !name.ends_with(".waypoints")) continue;
      const auto check = tests::run_skycap({"check", mission, "--route", (out() / name).string()});
      EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
      ++checked;
    }
  }
  EXPECT_GE(checked, 2);
}

TEST_F(District, ResumesUnfinishedSurveys) {
  const auto first = run({"--index", "1"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const auto partly = run({"--collect"});
  EXPECT_EQ(partly.exit_code, 1);
  EXPECT_THAT(partly.out, HasSubstr("1 of 2 surveyed"));
  const json before = results();
  EXPECT_TRUE(before["targets"][0]["survey"].is_null());
  EXPECT_THAT(before["targets"][0]["why_none"], HasSubstr("is not complete"));
  const fs::path item = out() / before["targets"][1]["survey"]["folder"].get<std::string>();
  const auto written = fs::last_write_time(item / "item.json");
  ASSERT_EQ(run().exit_code, 0);
  EXPECT_EQ(fs::last_write_time(item / "item.json"), written);
  const std::string table = read_content(out() / "targets.csv");
  fs::remove_all(out());
  ASSERT_EQ(run({}, 2).exit_code, 0);
  EXPECT_EQ(read_content(out() / "targets.csv"), table);
}

TEST_F(District, CutsOutSurroundingsOfEachTarget) {
  std::vector<Vector3d> far = positions;
  far.emplace_back(85, 0, 0);
  far.emplace_back(900, 0, 0);
  folder_.write("town.city.json", town(far));
  ASSERT_EQ(run({"--list"}).exit_code, 0);
  const std::string site = read_content(out() / "sites" / "house_2.city.json");
  EXPECT_THAT(site, AllOf(HasSubstr("house_2"), HasSubstr("house_3"), HasSubstr("house_4")));
  EXPECT_THAT(site, testing::Not(HasSubstr("house_5")));
}

// The scene of a target contains its neighbour. Free space that its survey observes in the boxes of
// other targets is kept for the common flight. A detached target needs no such box.
TEST_F(District, KeepsUnknownBoxesOfNeighbouringTargets) {
  folder_.write("town.city.json", town({{0, 0, 0}, {18, 0, 0}, {500, 0, 0}}));
  write("map: town.city.json\nvertical: ellipsoid\n");
  ASSERT_EQ(run({"--list"}).exit_code, 0);
  const auto district_plan = batch::read_district_plan(out() / batch::district_plan_name);
  ASSERT_EQ(district_plan.targets.size(), 3U);
  for (int house = 0; house < 3; ++house) {
    const fs::path file = out() / "missions" / ("house_" + std::to_string(house) + ".yaml");
    const config::MissionSetup mission = config::read_mission(file);
    EXPECT_TRUE(mission.scene().neighbours);
    const std::vector<Eigen::AlignedBox3d>& boxes = mission.flight().extra_unknown_boxes;
    ASSERT_EQ(boxes.size(), house < 2 ? 1U : 0U) << house;
    if (house == 2) continue;
    const Eigen::AlignedBox3d& other = district_plan.targets[1 - house].unknown;
    EXPECT_EQ(boxes[0].min(), other.min());
    EXPECT_EQ(boxes[0].max(), other.max());
  }
}

TEST_F(District, SelectsTargetsByPositionAndAttribute) {
  write("map: town.city.json\nvertical: ellipsoid\ntargets: {attribute: {number: '3'}}\n");
  EXPECT_THAT(run({"--list"}).out,
              AllOf(HasSubstr("house_3.yaml"), testing::Not(HasSubstr("house_2"))));
  const auto district_plan = batch::read_district_plan(out() / batch::district_plan_name);
  ASSERT_EQ(district_plan.targets.size(), 1U);
  EXPECT_NEAR(district_plan.targets[0].box.center().head<2>().norm(), 0.0, 0.02);
  EXPECT_NEAR(district_plan.targets[0].box.min().z(), 0.0, 0.02);
}

TEST_F(District, ReportsWhySelectionIsEmpty) {
  write("map: town.city.json\nvertical: ellipsoid\ntargets: {near: '48.0,11.0', distance: 10}\n");
  EXPECT_THAT(run().err, HasSubstr("key targets selects none of the 4 objects of"));
  write("map: town.city.json\nvertical: ellipsoid\ntargets: {id: [castle]}\n");
  EXPECT_THAT(run().err, HasSubstr("castle"));
}

TEST_F(District, RequiresTerrainOnSlope) {
  folder_.write("town.city.json", town({{0, 0, 0}, {60, 0, 7}, {120, 0, 3}}));
  const auto rejected = run();
  EXPECT_EQ(rejected.exit_code, 2);
  EXPECT_THAT(rejected.err,
              HasSubstr("differ by 7.0 m, and the ground between the targets is unknown"));
}

/// Returns terrain in cells of 6 m that rises from 380 m in the west to 387 m in the east.
std::string rising_ground() {
  constexpr int cells = 60;
  std::string row;
  for (int i = 0; i < cells; ++i) {
    const double east = -120.0 + 6.0 * (i + 0.5);
    row += std::to_string(std::clamp(380.0 + 7.0 * (east - 12.0) / 43.0, 380.0, 387.0)) + " ";
  }
  const Cube cube;
  std::string text = "ncols 60\nnrows 60\nxllcorner " + std::to_string(cube.low.x() - 120.0) +
                     "\nyllcorner " + std::to_string(cube.low.y() - 180.0) +
                     "\ncellsize 6\nNODATA_value -9999\n";
  for (int i = 0; i < cells; ++i) text += row + "\n";
  return text;
}

TEST_F(District, UsesTerrainOnSlope) {
  folder_.write("town.city.json", town({{0, 0, 0}, {60, 0, 7}}));
  folder_.write("ground.asc", rising_ground());
  write("map: town.city.json\nvertical: ellipsoid\ncrs: 'EPSG:25832'\nterrain: ground.asc\n");
  const auto surveyed = run({"--no-report"});
  ASSERT_EQ(surveyed.exit_code, 0) << surveyed.err << surveyed.out;
  const auto district_plan = batch::read_district_plan(out() / batch::district_plan_name);
  EXPECT_NEAR(district_plan.targets.at(0).box.min().z(), 0.0, 0.05);
  EXPECT_NEAR(district_plan.targets.at(1).box.min().z(), 7.0, 0.05);
  EXPECT_EQ(results().at("flight").at("views_flown"), results().at("flight").at("views"));
  const auto check = tests::run_skycap({"check", (out() / "flights" / "pad_1.yaml").string(),
                                        "--route", (out() / "flights" / "pad_1.plan").string()});
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
}

TEST_F(District, RejectsPadInsideBuilding) {
  const std::string map = "map: town.city.json\nvertical: ellipsoid\n";
  write(map);
  ASSERT_EQ(run({"--list"}).exit_code, 0);
  const std::string mission = read_content(out() / "flights" / "pad_1.yaml");
  const auto value = [&](const std::string& key) {
    const auto at = mission.find(key + ": ") + key.size() + 2;
    return mission.substr(at, mission.find(' ', at) - at);
  };
  // The centre of the district is next to all targets; the centre of the first house is not.
  write(map + "targets: {id: [house_0]}\n");
  ASSERT_EQ(run({"--list"}).exit_code, 0);
  const std::string house = read_content(out() / "flights" / "pad_1.yaml");
  const auto at = house.find("latitude_deg: ") + 14, to = house.find("longitude_deg: ") + 15;
  const std::string location =
      house.substr(at, house.find(' ', at) - at) + "," + house.substr(to, house.find(' ', to) - to);
  write(map + "pads: ['" + location + "']\n");
  const auto rejected = run();
  EXPECT_EQ(rejected.exit_code, 2);
  EXPECT_THAT(rejected.err,
              AllOf(HasSubstr("key pads: "), HasSubstr("must be on free, level and even ground")));
  write(map + "pads: ['" + value("latitude_deg") + "," + value("longitude_deg") + "']\n");
  const auto given = run({"--list"});
  EXPECT_EQ(given.exit_code, 0) << given.err;
  EXPECT_EQ(batch::read_district_plan(out() / batch::district_plan_name).pads.size(), 1U);
}

}  // namespace
}  // namespace skycap::missions
