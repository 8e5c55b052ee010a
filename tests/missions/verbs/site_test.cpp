// From one tile of a city model to a certified mission in two commands.
#include <fstream>
#include <iterator>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/place/prism.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/mission_priors.h"
#include "missions/derived/resolved_mission.h"
#include "tests/missions/prior/cube_files.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::Cube;
using tests::content_of;
using tests::TestFolder;

tests::ProgramRun run_skycap(const std::string& line) {
  std::istringstream words(line);
  return tests::run_skycap(std::vector<std::string>(std::istream_iterator<std::string>(words), {}));
}

/// Three buildings of 10 m with 15 m between them in a row eastward, in UTM 32, feet at 380 m; the
/// one in the middle has an address. One file, as an authority gives it.
std::string tile() {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    Cube cube;
    cube.low.x() += 25.0 * i;
    std::string one = citygml_of(cube);
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
  Site() { std::ofstream(folder_.path() / "tile.gml") << tile(); }

  tests::ProgramRun propose(const std::string& options) {
    return run_skycap("site " + path_ + "/tile.gml --vertical ellipsoid --out " + path_ +
                      "/house.yaml " + options);
  }
  file::Mission mission() const { return derived::read_mission(folder_.path() / "house.yaml"); }

  const TestFolder folder_;
  const std::string path_ = folder_.path().string();
};

TEST_F(Site, IsACertifiedMissionInTwoCommands) {
  const auto site = propose("--id DEBY_1");
  ASSERT_EQ(site.exit_code, 0) << site.err;
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "house.html"));
  const auto plan = run_skycap("plan " + path_ + "/house.yaml --out " + path_ + "/out");
  ASSERT_EQ(plan.exit_code, 0) << plan.err << plan.out;
  const json summary = json::parse(content_of(folder_.path() / "out" / "summary.json"));
  ASSERT_EQ(summary.at("targets").size(), 1U);
  EXPECT_EQ(summary.at("targets")[0].at("name"), "DEBY_1");
  EXPECT_GT(summary.at("targets")[0].at("coverage").get<double>(), 0.9);
  EXPECT_GE(summary.at("min_clearance_m").get<double>(), 2.0);
  // Of the file as autopilots read it, neighbours and all.
  const auto check =
      run_skycap("check " + path_ + "/house.yaml --route " + path_ + "/out/mission.plan");
  EXPECT_EQ(check.exit_code, 0) << check.out;
}

// Known places: the building's middle, its foot, and what must lie outside of everything.
TEST_F(Site, IsProposedAboutItsTarget) {
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  const file::Mission mission = this->mission();
  // echo 676330 5403905 | cs2cs EPSG:25832 EPSG:4326
  EXPECT_NEAR(mission.georeference.latitude_deg.value(), 48.76315751, 2e-7);
  EXPECT_NEAR(mission.georeference.longitude_deg.value(), 11.39950772, 2e-7);
  EXPECT_NEAR(mission.georeference.ellipsoid_height, 380.0, 0.011);
  const Vector3d pad = mission.flight.takeoff.value();
  const AlignedBox3d unknown = derived::unknown_box_of(mission);
  for (const prior::Prior& prior : derived::priors_of(mission).priors) {
    for (const prior::Object& object : prior.objects) {
      const AlignedBox3d box = geometry::bounding_box(object.mesh);
      EXPECT_GT(box.exteriorDistance(pad), 3.0 * mission.flight.clearance);
      EXPECT_EQ(unknown.contains(box.center().eval()), object.id == "DEBY_1");
    }
  }
  EXPECT_GT(unknown.exteriorDistance(pad), 2.0 * mission.flight.clearance);
  EXPECT_TRUE(geometry::contains(mission.site.geofence, pad.head<2>()));
  EXPECT_EQ(derived::priors_of(mission).priors.size(), 2U);
  EXPECT_EQ(derived::priors_of(mission).priors[1].objects.size(), 3U);
}

// Each value has a word on it, beside it or over it and others of its kind.
TEST_F(Site, IsCommentedValueByValue) {
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  std::istringstream text(content_of(folder_.path() / "house.yaml"));
  std::size_t values = 0;
  bool has_comment = false;
  for (std::string line; std::getline(text, line);) {
    const bool is_section = line[0] != ' ' && line[0] != '#' && line.ends_with(':');
    has_comment = (has_comment && !is_section) || line.find('#') != std::string::npos;
    if (is_section || line.find('#') < 4) continue;
    ++values;
    EXPECT_TRUE(has_comment) << line;
  }
  EXPECT_GT(values, 20U);
}

TEST_F(Site, IsPickedByNameAddressOrClick) {
  ASSERT_EQ(propose("--id DEBY_1").exit_code, 0);
  const std::string by_name = content_of(folder_.path() / "house.yaml");
  for (const char* pick : {"--at 48.76318391,11.39953620", "--at 48.76304965,11.39950258"}) {
    std::filesystem::remove(folder_.path() / "house.yaml");
    const auto run = propose(pick);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(content_of(folder_.path() / "house.yaml"), by_name);
  }
  std::filesystem::remove(folder_.path() / "house.yaml");
  const auto run =
      tests::run_skycap({"site", path_ + "/tile.gml", "--vertical", "ellipsoid", "--out",
                         path_ + "/house.yaml", "--attribute", "ThoroughfareName=Am Ring"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(content_of(folder_.path() / "house.yaml"), by_name);
}

TEST_F(Site, SaysWhatIsMissing) {
  EXPECT_THAT(propose("").err, AllOf(HasSubstr("holds 3 things, DEBY_0, DEBY_1, DEBY_2"),
                                     HasSubstr("--id, --at or --attribute")));
  EXPECT_THAT(propose("--id DEBY_7").err, HasSubstr("no object with the id DEBY_7"));
  EXPECT_THAT(propose("--at 48.75,11.39").err, HasSubstr("has nothing within 10 m"));
  EXPECT_THAT(propose("--at north").err, HasSubstr("--at is north; give LATITUDE,LONGITUDE"));
  EXPECT_THAT(propose("--id DEBY_1 --at 48,11").err, HasSubstr("give one of them"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "house.yaml"));
  std::ofstream(folder_.path() / "house.yaml") << "mine";
  EXPECT_THAT(propose("--id DEBY_1").err, HasSubstr("is there already"));
  EXPECT_EQ(content_of(folder_.path() / "house.yaml"), "mine");
}

}  // namespace
}  // namespace skycap::missions
