// From one tile of a city model to a verified mission in two commands.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/pose/prism.h"
#include "missions/config/mission_document.h"
#include "missions/config/resolve.h"
#include "missions/config/vehicle_reader.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/site_data/prior.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/site_data/cube_files.h"

namespace skycap::missions {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::Cube;
using tests::read_content;
using tests::TestFolder;

tests::ProgramRun run_skycap(const std::string& line) {
  std::istringstream words(line);
  return tests::run_skycap(std::vector<std::string>(std::istream_iterator<std::string>(words), {}));
}

/// Three buildings in a row to the east, 15 m apart.
const std::vector<Vector3d> in_a_row{{0, 0, 0}, {25, 0, 0}, {50, 0, 0}};

/// Returns a CityGML tile with 10 m buildings in UTM 32. Their bases are at 380 m plus the z
/// offset. The second building has an address.
std::string tile(const std::vector<Vector3d>& positions = in_a_row,
                 const std::string& crs = "EPSG:25832") {
  std::string text;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Cube cube;
    cube.low += positions[i];
    std::string one = make_citygml(cube, crs);
    const std::string name = "DEBY_" + std::to_string(i);
    one.replace(one.find("\"cube\""), 6, "\"" + name + "\"");
    if (i == 1) {
      one.insert(one.find("<bldg:function>"),
                 "<bldg:address><core:Address><xal:ThoroughfareName>Am Ring"
                 "</xal:ThoroughfareName></core:Address></bldg:address>");
    }
    const std::string member = "<cityObjectMember>", end = "</CityModel>";
    if (i == 0) text = one.substr(0, one.find(member));
    text += one.substr(one.find(member), one.find(end) - one.find(member));
  }
  return text + "</CityModel>\n";
}

class Site : public testing::Test {
 protected:
  Site() { write("tile.gml", tile()); }

  tests::ProgramRun propose(const std::string& options) {
    return run_skycap("site " + path_ + "/tile.gml --vertical ellipsoid --out " + path_ +
                      "/house.yaml " + options);
  }
  void remove_proposal() const {
    for (const char* name : {"house.yaml", "house.html"})
      std::filesystem::remove(folder_.path() / name);
  }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << content;
  }
  config::MissionSetup mission() const {
    return config::read_mission(folder_.path() / "house.yaml");
  }

  const TestFolder folder_;
  const std::string path_ = folder_.path().string();
};

TEST_F(Site, PlansVerifiedMissionInTwoCommands) {
  const auto site = propose("--id DEBY_1");
  ASSERT_EQ(site.exit_code, 0) << site.err;
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "house.html"));
  const auto plan = run_skycap("plan " + path_ + "/house.yaml --out " + path_ + "/out");
  ASSERT_EQ(plan.exit_code, 0) << plan.err << plan.out;
  const json summary = json::parse(read_content(folder_.path() / "out" / "summary.json"));
  ASSERT_EQ(summary.at("targets").size(), 1U);
  EXPECT_EQ(summary.at("targets")[0].at("name"), "DEBY_1");
  EXPECT_GT(summary.at("targets")[0].at("coverage").get<double>(), 0.9);
  EXPECT_GE(summary.at("min_clearance_m").get<double>(), 2.0);
  // The route file is checked against all buildings.
  const auto check =
      run_skycap("check " + path_ + "/house.yaml --route " + path_ + "/out/mission.plan");
  EXPECT_EQ(check.exit_code, 0) << check.out;
}

// A hill in the same file is higher than the maximum flight altitude at the target.
TEST_F(Site, PlansBelowHillsOfTile) {
  write("tile.gml", tile({{0, 0, 0}, {25, 0, 0}, {50, 0, 0}, {900, 0, 150}}));
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  ASSERT_LT(mission().flight().airspace.max_height.value(), 150.0);
  const auto plan = run_skycap("plan " + path_ + "/house.yaml --out " + path_ + "/out");
  EXPECT_EQ(plan.exit_code, 0) << plan.err << plan.out;
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out" / "mission.plan"));
}

// The first view is never inside a neighbouring building.
TEST_F(Site, StartsOutsideNeighbouringBuildings) {
  std::vector<Vector3d> crowd;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) crowd.emplace_back(16.0 * x, 16.0 * y, 0.0);
  }
  write("tile.gml", tile(crowd));
  ASSERT_EQ(propose("--id DEBY_12").exit_code, 0);
  const config::MissionSetup mission = this->mission();
  const evaluation::SurveyScene scene(mission.simulation, folder_.path(), 0);
  std::set<double> heights;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Vector3d position = scene.first_view(seed).position;
    heights.insert(position.z());
    for (const site_data::Object& object : mission.scene().priors->priors[1].objects) {
      EXPECT_GE(geometry::bounding_box(object.mesh).exteriorDistance(position),
                mission.flight().clearance)
          << seed << " in " << object.id;
    }
  }
  EXPECT_GT(heights.size(), 30U);
}

// Known positions: the centre of the building, its base, and points outside all obstacles.
TEST_F(Site, ProposesMissionAroundTarget) {
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  const config::MissionSetup mission = this->mission();
  const flight::GeodeticPoint& origin = mission.flight().site.origin;
  // echo 676330 5403905 | cs2cs EPSG:25832 EPSG:4326
  EXPECT_NEAR(origin.latitude_deg, 48.76315751, 2e-7);
  EXPECT_NEAR(origin.longitude_deg, 11.39950772, 2e-7);
  EXPECT_NEAR(origin.height, 380.0, 0.011);
  const Vector3d pad = mission.flight().takeoff.value();
  const AlignedBox3d& unknown = mission.flight().unknown_box;
  for (const site_data::Prior& prior : mission.scene().priors->priors) {
    for (const site_data::Object& object : prior.objects) {
      const AlignedBox3d box = geometry::bounding_box(object.mesh);
      EXPECT_GT(box.exteriorDistance(pad), 3.0 * mission.flight().clearance);
      EXPECT_EQ(unknown.contains(box.center().eval()), object.id == "DEBY_1");
    }
  }
  EXPECT_GT(unknown.exteriorDistance(pad), 2.0 * mission.flight().clearance);
  EXPECT_TRUE(geometry::contains(mission.flight().airspace.geofence, pad.head<2>()));
  EXPECT_EQ(mission.scene().priors->priors.size(), 2U);
  EXPECT_EQ(mission.scene().priors->priors[1].objects.size(), 3U);
}

// Each value has a comment in its line or above it.
TEST_F(Site, CommentsEveryValue) {
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  std::istringstream text(read_content(folder_.path() / "house.yaml"));
  std::size_t values = 0;
  bool is_under_comment = false;
  for (std::string line; std::getline(text, line);) {
    const bool is_comment = line.find_first_not_of(' ') == line.find('#');
    const bool is_section = line[0] != ' ' && line.ends_with(':');
    if (!is_comment && !is_section) {
      ++values;
      EXPECT_TRUE(is_under_comment || line.find('#') != std::string::npos) << line;
    }
    is_under_comment = is_comment;
  }
  EXPECT_GT(values, 20U);
}

TEST_F(Site, SelectsTargetByIdAttributeOrPosition) {
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  const std::string by_name = read_content(folder_.path() / "house.yaml");
  for (const char* pick : {"--at 48.76318391,11.39953620", "--at 48.76304965,11.39950258"}) {
    remove_proposal();
    const auto run = propose(pick);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(read_content(folder_.path() / "house.yaml"), by_name);
  }
  remove_proposal();
  const auto run =
      tests::run_skycap({"site", path_ + "/tile.gml", "--vertical", "ellipsoid", "--out",
                         path_ + "/house.yaml", "--attribute", "ThoroughfareName=Am Ring"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_content(folder_.path() / "house.yaml"), by_name);
}

TEST_F(Site, ReportsMissingOptions) {
  EXPECT_THAT(propose("--id DEBY_7").err, HasSubstr("no object with id DEBY_7"));
  EXPECT_THAT(propose("--at 48.75,11.39").err, HasSubstr("contains no object within 10 m"));
  EXPECT_THAT(propose("--at north").err, HasSubstr("--at is north; it must be LATITUDE,LONGITUDE"));
  EXPECT_THAT(propose("--id DEBY_1 --at 48,11").err, HasSubstr("mutually exclusive"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "house.yaml"));
  std::ofstream(folder_.path() / "house.yaml") << "mine";
  EXPECT_THAT(propose("--id DEBY_1").err, HasSubstr("house.yaml already exists"));
  EXPECT_EQ(read_content(folder_.path() / "house.yaml"), "mine");
  std::filesystem::rename(folder_.path() / "house.yaml", folder_.path() / "house.html");
  EXPECT_THAT(propose("--id DEBY_1").err, HasSubstr("house.html already exists"));
  EXPECT_EQ(read_content(folder_.path() / "house.html"), "mine");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "house.yaml"));
}

// Without a selected object, the command writes an HTML page with the command for each object and
// no mission.
TEST_F(Site, ShowsTheObjectsWhereNoneIsChosen) {
  write("tile.gml", tile({{0, 0, 0}, {25, 0, 0}, {50, 0, 0}}));
  const auto run = propose("--vehicle mavic_3e");
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("contains 3 objects, DEBY_0, DEBY_1, DEBY_2; no mission"),
                             HasSubstr("house.objects.html")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "house.yaml"));
  const std::string page = read_content(folder_.path() / "house.objects.html");
  const std::string begin = "id=\"map\">";
  const std::size_t at = page.find(begin) + begin.size();
  const json map = json::parse(page.substr(at, page.find("</script>", at) - at));
  EXPECT_EQ(map.at("command"), "skycap site " + path_ +
                                   "/tile.gml --vertical ellipsoid --vehicle " + "mavic_3e --out " +
                                   path_ + "/house.yaml");
  ASSERT_EQ(map.at("objects").size(), 3U);
  const json& second = map.at("objects")[1];
  EXPECT_EQ(second.at("quoted"), "'DEBY_1'");
  EXPECT_EQ(second.at("height"), 10.0);
  // The roof and the floor of 10 m, in decimetres. Walls are not visible from above.
  const std::string outline = second.at("outline");
  EXPECT_EQ(std::ranges::count(outline, 'M'), 4) << outline;
  EXPECT_NEAR(map.at("view")[2].get<double>(), 700.0, 5.0);  // UTM grid north is not true north
  EXPECT_EQ(page.find("http"), page.find("http-equiv"));     // the page loads no external resources
  // The command on the page proposes a mission.
  EXPECT_EQ(propose("--vehicle mavic_3e --id DEBY_1").exit_code, 0);
}

TEST_F(Site, ListsAllThatIsMissingAtOnce) {
  write("map.geojson", make_geojson(Cube()));
  const auto run = run_skycap("site " + path_ + "/map.geojson --out " + path_ + "/house.yaml");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(
      run.err,
      HasSubstr("map.geojson: missing height of object cube, base height of outlines; set --height "
                "METRES, --base ground, --base METRES with --vertical, or --terrain FILE"));
}

TEST_F(Site, StandsOnTheGroundHereWithoutATerrain) {
  write("map.geojson", make_geojson(Cube()));
  const auto run = run_skycap("site " + path_ + "/map.geojson --height 12 --base ground --out " +
                              path_ + "/house.yaml");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const config::MissionSetup proposed = mission();
  EXPECT_EQ(proposed.flight().takeoff.value().z(), 0.0);
  const AlignedBox3d box = proposed.scene().priors->priors[0].box;
  EXPECT_NEAR(box.min().z(), 0.0, 0.01);
  EXPECT_NEAR(box.max().z(), 12.0, 0.01);
  EXPECT_THAT(read_content(folder_.path() / "house.yaml"), HasSubstr("vertical: takeoff, base: 0"));
  EXPECT_THAT(
      run_skycap("site " + path_ + "/map.geojson --height 12 --base ground --vertical geoid").err,
      HasSubstr("--base ground conflicts with --vertical"));
}

// The user's reference system overrides a name that PROJ does not know.
TEST_F(Site, TakesTheReferenceSystemOfTheUser) {
  write("tile.gml", tile(in_a_row, "urn:adv:crs:ETRS89_UTM32*DE_DHHN2099_NH*GCG2099"));
  EXPECT_EQ(propose("--id DEBY_1").exit_code, 2);
  const auto run = propose("--id DEBY_1 --crs EPSG:25832");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NEAR(mission().flight().site.origin.latitude_deg, 48.76315751, 2e-7);
}

// Neighbours hide walls from the simulated sensor, but the whole target is evaluated.
TEST_F(Site, ProposesWhatCheckFindsNoFaultWith) {
  ASSERT_EQ(propose("--id DEBY_1 --vehicle mavic_3e").exit_code, 0);
  const config::MissionSetup proposed = mission();
  EXPECT_TRUE(proposed.scene().neighbours);
  EXPECT_LE(proposed.survey().planner.scene_box->min().z(), -0.5);
  EXPECT_EQ(proposed.text("planner.preset"), "building");
  // The vehicle's own camera, with fewer pixels.
  EXPECT_EQ(proposed.text("sensor.preset"), "dji_mavic_3e_wide");
  EXPECT_NEAR(proposed.sensor().camera.camera.horizontal_fov, 1.227, 1e-3);
  EXPECT_EQ(proposed.sensor().camera.camera.width, 320);
  const auto check = run_skycap("check " + path_ + "/house.yaml");
  EXPECT_EQ(check.exit_code, 0) << check.out;
  EXPECT_EQ(check.out.find("Warning"), std::string::npos) << check.out;
}

// Without RTK, the position error of a vehicle may exceed what the default clearance allows.
TEST_F(Site, KeepsEveryVehicleFarEnoughAway) {
  for (const std::string_view vehicle : config::vehicle_presets()) {
    remove_proposal();
    const auto run = propose("--id DEBY_1 --vehicle " + std::string(vehicle));
    ASSERT_EQ(run.exit_code, 0) << vehicle << ": " << run.err;
    EXPECT_GE(mission().flight().budget().margin, 0.5 - 1e-9) << vehicle;
  }
}

// The second command makes the photo table and the verified route.
TEST_F(Site, PlansPhotosInTwoCommands) {
  const auto site = propose("--id DEBY_1 --sensor mavic_3e_wide --gsd 0.02");
  ASSERT_EQ(site.exit_code, 0) << site.err;
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "house.html"));
  const config::MissionSetup proposed = mission();
  EXPECT_TRUE(proposed.document->is_photo());
  EXPECT_EQ(proposed.text("flight.vehicle"), "mavic_3e");
  EXPECT_EQ(proposed.text("photo.pass"), "final");
  EXPECT_EQ(proposed.text("photo.poses"), "unknown");  // no RTK
  EXPECT_EQ(proposed.scene().priors->priors[1].objects.size(), 3U);
  // No view is within 54 m of the pad, where DJI vehicles return at their own height.
  const AlignedBox3d target = proposed.scene().priors->priors[0].box;
  const Vector3d pad = proposed.flight().takeoff.value();
  EXPECT_GT(target.exteriorDistance(pad), proposed.survey().planner.view_distance + 54.0);
  const auto check = run_skycap("check " + path_ + "/house.yaml");
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  const auto plan = run_skycap("plan " + path_ + "/house.yaml --out " + path_ +
                               "/out --set photo.patterns=[dome]");
  ASSERT_EQ(plan.exit_code, 0) << plan.err << plan.out;
  const json summary = json::parse(read_content(folder_.path() / "out" / "summary.json"));
  EXPECT_GT(summary.at("photo").at("photos").get<int>(), 10);
  EXPECT_EQ(summary.at("flight").at("route").at("skipped_views").size(), 0U);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out" / "mission.kmz"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out" / "photos.csv"));
  EXPECT_THAT(read_content(folder_.path() / "out" / "report.html"),
              HasSubstr("\"kind\":\"photos\""));
}

// An outline with a height: a coarse flight first.
TEST_F(Site, ProposesTwoFlightsForAnOutline) {
  write("map.geojson", make_geojson(Cube()));
  const auto run = run_skycap("site " + path_ +
                              "/map.geojson --height 12 --base ground --sensor zenmuse_p1_35 --gsd "
                              "0.004 --out " +
                              path_ + "/house.yaml");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(mission().text("photo.pass"), "coarse");
  EXPECT_EQ(mission().text("flight.vehicle"), "m350_rtk");
  EXPECT_EQ(mission().text("photo.poses"), "known");
  EXPECT_THAT(read_content(folder_.path() / "house.yaml"), HasSubstr("# First of two flights"));
}

TEST_F(Site, RejectsPhotoCamerasWithoutSamplingDistance) {
  EXPECT_THAT(propose("--id DEBY_1 --sensor mavic_3e_wide").err,
              HasSubstr("--sensor mavic_3e_wide is a photo camera and requires a ground sampling "
                        "distance; set --gsd"));
  EXPECT_THAT(propose("--id DEBY_1 --gsd 0.005").err, HasSubstr("--gsd requires a photo camera"));
  EXPECT_THAT(propose("--id DEBY_1 --gsd 0.005 --sensor intel_d435").err,
              HasSubstr("unknown photo camera intel_d435; expected one of: air_3_wide"));
  EXPECT_THAT(propose("--id DEBY_1 --gsd 0.0005 --sensor mavic_3e_wide").err,
              HasSubstr("requires a view distance of 1.88 m, which is less than the stand-off"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "house.yaml"));
}

TEST_F(Site, TakesTheSensorOfTheUser) {
  ASSERT_EQ(propose("--id DEBY_1 --vehicle m350_rtk --sensor dji_zenmuse_l2").exit_code, 0);
  EXPECT_EQ(mission().lidar, "dji_zenmuse_l2");
  remove_proposal();
  ASSERT_EQ(propose("--id DEBY_1 --vehicle generic_ardupilot --sensor intel_d435").exit_code, 0);
  EXPECT_EQ(mission().sensor().camera.camera.width, 848);
  EXPECT_LE(mission().survey().planner.view_distance, 3.0);
  remove_proposal();
  EXPECT_THAT(propose("--id DEBY_1 --sensor d345").err, HasSubstr("unknown sensor d345"));
}

// The datum of a file takes precedence over the option, which applies to files without a datum.
TEST_F(Site, AppliesVerticalOptionOnlyToFilesWithoutDatum) {
  // Ground above the EGM96 geoid: the top of a slab at the base of the buildings.
  const double undulation = site_data::egm96_undulation(48.7632, 11.3995);
  Cube ground;
  ground.size = {400.0, 400.0, 1.0};
  ground.low = {676130.0, 5403705.0, 379.0 - undulation};
  write("ground.gml", make_citygml(ground, "EPSG:25832+5773"));
  const auto run = propose("--id DEBY_1 --terrain " + path_ + "/ground.gml");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NEAR(mission().flight().takeoff.value().z(), 0.0, 0.05);
  EXPECT_FALSE(mission().scene().priors->sources.back().vertical.has_value());
  EXPECT_TRUE(mission().scene().priors->sources.front().vertical.has_value());
}

// Heights above the DHHN2016 geoid, whose grid is not in Debian. EGM96 differs from it by metres.
TEST_F(Site, UsesEgm96ForMissingGeoidGrid) {
  write("tile.gml", tile(in_a_row, "EPSG:25832+7837"));
  const auto run =
      run_skycap("site " + path_ + "/tile.gml --id DEBY_1 --out " + path_ + "/house.yaml");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("heights above the geoid refer to EGM96"));
  EXPECT_EQ(run.err.find("missing vertical datum"), std::string::npos) << run.err;
  EXPECT_NEAR(mission().flight().site.origin.height,
              380.0 + site_data::egm96_undulation(48.7632, 11.3995), 0.02);
}

// Heights of official tiles are above sea level, also if the tile names a horizontal system only.
TEST_F(Site, AssumesSeaLevelWithWarningIfMapHasNoVerticalDatum) {
  const std::string command =
      "site " + path_ + "/tile.gml --id DEBY_1 --out " + path_ + "/house.yaml";
  const auto run = run_skycap(command);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("tile.gml: missing vertical datum; heights are assumed to be "
                                 "AMSL (EGM96). Set --vertical if they are not"));
  EXPECT_THAT(read_content(folder_.path() / "house.yaml"), HasSubstr("vertical: geoid"));
  EXPECT_NEAR(mission().flight().site.origin.height,
              380.0 + site_data::egm96_undulation(48.7632, 11.3995), 0.02);
  // The datum of another file must not be guessed: an error would move it relative to the target.
  write("more.gml", tile(in_a_row));
  EXPECT_THAT(run_skycap(command + "2.yaml --obstacle " + path_ + "/more.gml").err,
              HasSubstr("more.gml: missing vertical datum; set --vertical ellipsoid or geoid"));
}

TEST_F(Site, AppliesHeightOptionToObjectsWithoutHeight) {
  Cube low, high;
  high.low.x() += 30.0;
  std::string map = make_geojson(low);
  std::string other = make_geojson(high);
  other.replace(other.find("\"cube\""), 6, "\"tower\",\"height\":20");
  const auto find_feature = [](const std::string& text) {
    const auto begin = text.find("{\"type\":\"Feature\",");
    return text.substr(begin, text.rfind("]}") - begin);
  };
  map.insert(map.rfind("]}"), "," + find_feature(other));
  write("map.geojson", map);
  const auto run = run_skycap("site " + path_ + "/map.geojson --id cube --height 12 --base 380 " +
                              "--out " + path_ + "/house.yaml");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const config::MissionSetup proposed = mission();
  const auto& priors = proposed.scene().priors->priors;
  ASSERT_EQ(priors.size(), 2U);
  EXPECT_NEAR(priors[0].box.sizes().z(), 12.0, 0.01);
  EXPECT_NEAR(priors[1].box.max().z(), 20.0, 0.01);
  ASSERT_EQ(priors[1].objects.size(), 2U);
}

// File names may contain special characters of YAML.
TEST_F(Site, AcceptsFilesOfAnyName) {
  const std::string name = "a 'tile': #1 \\n \"{x}\".gml";
  std::filesystem::rename(folder_.path() / "tile.gml", folder_.path() / name);
  const auto run = tests::run_skycap({"site", path_ + "/" + name, "--vertical", "ellipsoid", "--id",
                                      "DEBY_1", "--out", path_ + "/house.yaml"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(mission().scene().priors->sources.front().file.filename(), name);
}

/// A tree crown of 3 m whose lowest points are 5 m above the pad, measured by a laser scanner:
/// eight points.
TEST_F(Site, KeepsPadClearOfTreeCrown) {
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  const Vector3d free_pad = mission().flight().takeoff.value();
  remove_proposal();
  Cube crown;
  crown.size.setConstant(3.0);
  crown.low = Vector3d(676330.0, 5403905.0, 385.0) + free_pad - Vector3d(1.5, 1.5, 0.0);
  write("tree.las", make_las(crown, 4, 6));
  const auto run = propose("--id DEBY_1 --crs EPSG:25832 --obstacle " + path_ + "/tree.las");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Vector3d pad = mission().flight().takeoff.value();
  const AlignedBox3d tree = mission().scene().priors->priors.back().box;
  const AlignedBox3d climb(pad, pad + Vector3d(0.0, 0.0, 20.0));
  EXPECT_GE(climb.exteriorDistance(tree), mission().flight().clearance);
  EXPECT_LT(AlignedBox3d(free_pad, free_pad + Vector3d(0.0, 0.0, 20.0)).exteriorDistance(tree),
            mission().flight().clearance);
}

/// A target requires surfaces. The datum of --vertical is used before this is reported.
TEST_F(Site, RejectsCloudsAsTargets) {
  Cube cube;
  cube.low = Vector3d(676330.0, 5403905.0, 385.0);
  write("cloud.las", make_las(cube, 4, 6));
  for (const std::string vertical : {"geoid", "ellipsoid"}) {
    const tests::ProgramRun run =
        tests::run_skycap({"site", path_ + "/cloud.las", "--crs", "EPSG:25832", "--vertical",
                           vertical, "--out", path_ + "/house.yaml"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr("cloud.las: contains no object surfaces; a target requires "
                                   "them. Reconstruct a mesh (skycap reconstruct)"));
  }
}

// South of the houses, where pads are searched first, the terrain has a slope of 50%.
TEST_F(Site, PutsPadOnLevelGround) {
  std::string grid =
      "ncols 80\nnrows 80\nxllcorner 676130\nyllcorner 5403705\ncellsize 5\n"
      "NODATA_value -9999\n";
  for (int row = 0; row < 80; ++row) {
    const double fall = std::max(0.0, 5403900.0 - (5403705.0 + 5.0 * (79.5 - row)));
    for (int column = 0; column < 80; ++column) grid += std::to_string(380.0 - 0.5 * fall) + " ";
    grid += "\n";
  }
  write("ground.asc", grid);
  const auto run = propose("--id DEBY_1 --crs EPSG:25832 --terrain " + path_ + "/ground.asc");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Vector3d pad = mission().flight().takeoff.value();
  EXPECT_NEAR(pad.z(), 0.0, 0.05);
  EXPECT_GT(pad.y(), 0.0);
}

}  // namespace
}  // namespace skycap::missions
