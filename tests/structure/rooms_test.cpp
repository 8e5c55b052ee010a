// The house: which room may know which, and how large its things may be.
// docs/development/architecture.md draws the same table.

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/structure/source_text.h"
#include "tests/structure/source_tree.h"
#include "tests/support/temporary_folder.h"

namespace skycap::structure {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The rows, each with all that it may use; "geometry" and its rooms are open to every room.
Rooms house() {
  const std::vector<std::string> geometry = {
      "geometry",          "geometry/place", "geometry/points", "geometry/directions",
      "geometry/surfaces", "geometry/io",    "geometry/io/laz", "geometry/io/e57"};
  Rooms rooms = {
      {"geometry", {}},
      {"geometry/place", {"geometry"}},
      {"geometry/points", {"geometry", "geometry/place"}},
      {"geometry/directions", {"geometry", "geometry/place"}},
      {"geometry/surfaces", {"geometry", "geometry/place"}},
      {"geometry/io/laz", {"geometry"}},
      {"geometry/io/e57", {"geometry"}},
      {"geometry/io",
       {"geometry", "geometry/place", "geometry/points", "geometry/surfaces", "geometry/io/laz",
        "geometry/io/e57"}},
  };
  const auto add = [&](const std::string& room, std::vector<std::string> others) {
    others.insert(others.end(), geometry.begin(), geometry.end());
    rooms[room] = std::move(others);
  };
  add("sim/scene", {});
  add("sim/models/masonry", {"sim/scene"});
  add("sim/models/families", {"sim/models/masonry", "sim/scene"});
  add("sim/models", {"sim/models/masonry", "sim/models/families", "sim/scene"});
  add("sim/sensors", {"sim/scene"});

  add("survey", {});
  add("survey/see", {"survey"});
  add("survey/skycap/raster", {"survey"});
  add("survey/skycap", {"survey", "survey/skycap/raster"});
  add("survey/volumetric", {"survey"});

  add("flight/space", {});
  add("flight/autopilot", {});
  add("flight/motion", {"flight/space", "flight/autopilot"});
  add("flight/paths", {"flight/space"});
  add("flight/way_home", {"flight/space", "flight/motion", "flight/paths"});
  add("flight/route", {"flight/space", "flight/motion", "flight/paths", "flight/way_home"});
  add("flight/export",
      {"flight/space", "flight/motion", "flight/paths", "flight/way_home", "flight/route"});
  add("flight/interpreter", {"flight/space", "flight/autopilot", "flight/motion", "flight/export"});
  add("flight/link", {});
  add("flight/calibration", {"flight/space", "flight/autopilot", "flight/motion", "flight/export"});
  add("flight/fly_test", {"flight/space", "flight/autopilot", "flight/motion", "flight/way_home",
                          "flight/interpreter"});
  add("flight/fleet", {"flight/space", "flight/motion", "flight/paths", "flight/way_home",
                       "flight/route", "flight/fly_test"});
  add("flight/district", {"flight/space", "flight/motion", "flight/way_home", "flight/route"});

  std::vector<std::string> below;  // what missions/ composes
  for (const auto& [room, others] : rooms) {
    if (!room.starts_with("geometry")) below.push_back(room);
  }
  const std::string m = "missions/";
  const auto add_mission_room = [&](const std::string& room, const auto&... others) {
    std::vector<std::string> all = below;
    all.push_back("missions");  // version.h alone
    (all.push_back(m + others), ...);
    add(m + room, std::move(all));
  };
  add_mission_room("plugins");
  add_mission_room("prior/formats", "plugins");
  add_mission_room("prior", "plugins", "prior/formats");
  add_mission_room("file", "prior");
  add_mission_room("judge");
  add_mission_room("equipment", "file");
  add_mission_room("derived", "file", "equipment", "prior");
  add_mission_room("scene", "file", "equipment", "derived", "judge", "plugins", "prior");
  add_mission_room("site", "file", "derived", "prior");
  add_mission_room("fleet", "file", "derived");
  add_mission_room("proof", "file", "derived", "fleet");
  add_mission_room("recording", "file", "derived", "plugins");
  add_mission_room("run", "prior", "file", "derived", "judge", "scene");
  add_mission_room("anew", "file", "derived");
  add_mission_room("package", "prior", "file", "equipment", "derived", "judge", "scene", "run",
                   "anew", "fleet");
  add_mission_room("report", "prior", "file", "derived", "scene", "run", "fleet", "package");
  add_mission_room("live", "file", "derived", "scene", "run");
  add_mission_room("dataset", "file", "plugins", "live");
  add_mission_room("fly", "file", "derived", "scene", "run", "live");
  add_mission_room("benchmark", "file", "derived", "judge", "plugins", "scene", "run", "package");
  add_mission_room("campaign", "file", "equipment", "derived", "judge", "plugins", "scene", "run",
                   "package", "benchmark");
  add_mission_room("district", "prior", "file", "equipment", "derived", "scene", "site", "package",
                   "benchmark", "campaign");
  add_mission_room("library", "file", "equipment", "derived", "judge", "scene", "recording", "run",
                   "package");
  add_mission_room("verbs", "prior", "file", "equipment", "derived", "judge", "plugins", "scene",
                   "recording", "run", "package", "report", "live", "dataset", "fly", "benchmark",
                   "campaign", "site", "proof", "fleet");
  add_mission_room("verbs/items", "verbs", "package", "benchmark", "campaign", "district");
  // A verb's sources know what the verbs share, and nobody knows them.
  add_mission_room("verbs/clouds", "file", "equipment", "derived", "judge", "plugins", "scene",
                   "recording", "package", "campaign", "verbs");
  // As a user of the library: public headers.
  add("python",
      {"sim/models", "sim/sensors", "survey", "flight/space", "flight/route", "missions/library"});
  return rooms;
}

std::vector<SourceFile> product() {
  return read_sources(SKYCAP_SOURCE_DIR,
                      {"geometry", "sim", "survey", "flight", "missions", "python"});
}

/// With what stands beside the house.
std::vector<SourceFile> all_sources() {
  return read_sources(SKYCAP_SOURCE_DIR, {"mathematics", "geometry", "sim", "survey", "flight",
                                          "missions", "python", "library", "clients", "tests"});
}

TEST(Rooms, AreEnteredInOneDirectionOnly) {
  EXPECT_THAT(forbidden_includes(product(), house()), IsEmpty());
  EXPECT_THAT(circular_rooms(house()), IsEmpty());
  EXPECT_THAT(circular_headers(product()), IsEmpty());
}

TEST(Rooms, KeepHeavyHeadersInSources) {
  EXPECT_THAT(heavy_headers(product(), {"CGAL/", "pcl/", "mrpt/", "ompl/", "embree3/", "gdal",
                                        "ogr", "cpl_", "ceres/", "nlopt"}),
              IsEmpty());
}

TEST(Rooms, AreNotCrowded) { EXPECT_THAT(crowded_rooms(product(), 30), IsEmpty()); }

TEST(Sources, AreNotLong) {
  EXPECT_THAT(long_files(SKYCAP_SOURCE_DIR, all_sources(), 400), IsEmpty());
}

TEST(Sources, HaveNoLongFunctions) {
  EXPECT_THAT(long_functions(SKYCAP_SOURCE_DIR, product(), 60), IsEmpty());
}

TEST(Sources, DrawInAStatedOrder) {
  EXPECT_THAT(unordered_draws(SKYCAP_SOURCE_DIR, all_sources()), IsEmpty());
}

/// A mesh is the truth; points measured of it are not.
TEST(Rooms, HideTheTruthFromPlanners) {
  for (const SourceFile& source : product()) {
    if (!source.path.starts_with("survey/")) continue;
    EXPECT_THAT(source.own, testing::Not(testing::Contains(HasSubstr("surfaces/mesh"))))
        << source.path;
  }
}

/// A tree of two rooms, upper and lower, with whatever fault a test plants.
class PlantedFault : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) {
    const std::filesystem::path file = folder_.path() / path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  std::vector<SourceFile> sources() const { return read_sources(folder_.path(), {"house"}); }
  std::filesystem::path root() const { return folder_.path(); }

  const Rooms rooms_ = {{"house/lower", {}}, {"house/upper", {"house/lower"}}};

 private:
  testing_support::TemporaryFolder folder_;
};

TEST_F(PlantedFault, AnIncludeAgainstTheDirectionIsFound) {
  write("house/upper/roof.h", "#include \"house/lower/floor.h\"\n");
  write("house/lower/floor.h", "");
  EXPECT_THAT(forbidden_includes(sources(), rooms_), IsEmpty());
  write("house/lower/floor.cpp", "#include \"house/upper/roof.h\"\n");
  EXPECT_THAT(forbidden_includes(sources(), rooms_),
              ElementsAre("house/lower/floor.cpp: house/lower may not use house/upper/roof.h"));
}

TEST_F(PlantedFault, AFileWithoutARoomIsFound) {
  write("house/shed/tool.h", "");
  EXPECT_THAT(forbidden_includes(sources(), rooms_), ElementsAre(HasSubstr("in no room")));
}

TEST_F(PlantedFault, CirclesAreFound) {
  write("house/lower/egg.h", "#include \"house/lower/hen.h\"\n");
  write("house/lower/hen.h", "#include \"house/lower/egg.h\"\n");
  EXPECT_THAT(circular_headers(sources()), ElementsAre("house/lower/egg.h", "house/lower/hen.h"));
  EXPECT_THAT(circular_rooms({{"a", {"b"}}, {"b", {"c"}}, {"c", {"a"}}}),
              ElementsAre("a", "b", "c"));
}

TEST_F(PlantedFault, AHeavyHeaderIsFoundInHeadersOnly) {
  write("house/lower/tree.cpp", "#include <CGAL/Kd_tree.h>\n");
  EXPECT_THAT(heavy_headers(sources(), {"CGAL/"}), IsEmpty());
  write("house/lower/tree.h", "#include <CGAL/Kd_tree.h>\n");
  EXPECT_THAT(heavy_headers(sources(), {"CGAL/"}), ElementsAre(HasSubstr("house/lower/tree.h")));
}

TEST_F(PlantedFault, ALongFileIsFound) {
  write("house/lower/a.h", "//\n//\n//\n");
  EXPECT_THAT(long_files(root(), sources(), 3), IsEmpty());
  EXPECT_THAT(long_files(root(), sources(), 2), ElementsAre("house/lower/a.h has 3 lines"));
}

TEST_F(PlantedFault, ALongFunctionIsFoundWhereverItStands) {
  write("house/lower/a.cpp",
        "namespace a {\nstruct B : C<D> {\n  int e = 1'000;\n  void f() const {\n\n\n  }\n};\n"
        "/* { */ const char* g = \"{\\\"{\"; char h = '{';\n"
        "template <typename T>\nstd::vector<T> i(T) {\n  if (true) {\n  }\n}\n}\n");
  EXPECT_THAT(long_functions(root(), sources(), 4), IsEmpty());
  EXPECT_THAT(long_functions(root(), sources(), 3),
              ElementsAre("house/lower/a.cpp:4 has 4 lines", "house/lower/a.cpp:11 has 4 lines"));
}

TEST_F(PlantedFault, DrawsInOneCallAreFound) {
  write("house/lower/a.cpp",
        "Vector3d a(normal(random), 1, normal(random));\n"
        "f(i + dice(),\n  row + dice());\n"
        "f(box(draw.between(1, 2), 3), draw.between(2, 3));\n"
        "Vector3d b{normal(random), normal(random)};  // f(dice(), dice())\n"
        "f(Vector3d{dice(), dice()}, 1); double c = dice(), d = dice();\n"
        "for (int i = 0; i < n; ++i) f(draw, draws.between(1, 2));\n");
  EXPECT_THAT(unordered_draws(root(), sources()),
              ElementsAre("house/lower/a.cpp:1", "house/lower/a.cpp:2", "house/lower/a.cpp:4"));
}

TEST_F(PlantedFault, ACrowdIsFound) {
  for (const char* name : {"a.h", "b.h", "c.h"}) write(std::string("house/lower/") + name, "");
  EXPECT_THAT(crowded_rooms(sources(), 3), IsEmpty());
  EXPECT_THAT(crowded_rooms(sources(), 2), ElementsAre("house/lower has 3 files"));
}

}  // namespace
}  // namespace skycap::structure
