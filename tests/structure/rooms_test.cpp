// Allowed includes between folders, as in docs/development/architecture.md. Between libraries the
// linker checks them as well (tests links/NAME). Within a library, only this test does.

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/structure/source_text.h"
#include "tests/structure/source_tree.h"
#include "tests/support/not_empty.h"
#include "tests/support/temporary_folder.h"

namespace skycap::structure {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Returns the allowed includes of each module. All modules may include "geometry" and its modules.
Modules architecture() {
  const std::vector<std::string> geometry = {
      "geometry",          "geometry/pose", "geometry/points", "geometry/spherical_cap",
      "geometry/surfaces", "geometry/io",   "geometry/io/las", "geometry/io/e57",
      "geometry/io/text"};
  Modules modules = {
      {"geometry", {}},
      {"geometry/pose", {"geometry"}},
      {"geometry/points", {"geometry", "geometry/pose"}},
      {"geometry/spherical_cap", {"geometry", "geometry/pose"}},
      {"geometry/surfaces", {"geometry", "geometry/pose"}},
      {"geometry/io/e57", {"geometry"}},
      {"geometry/io/text", {"geometry"}},
      {"geometry/io",
       {"geometry", "geometry/pose", "geometry/points", "geometry/surfaces", "geometry/io/e57",
        "geometry/io/text"}},
      {"geometry/io/las", {"geometry", "geometry/io"}},
  };
  const auto add = [&](const std::string& module_name, std::vector<std::string> others) {
    others.insert(others.end(), geometry.begin(), geometry.end());
    modules[module_name] = std::move(others);
  };
  add("sim/scene", {});
  add("sim/photos", {"sim/scene"});
  add("sim/models/masonry", {"sim/scene"});
  add("sim/models/families", {"sim/models/masonry", "sim/scene"});
  add("sim/models", {"sim/models/masonry", "sim/models/families", "sim/scene"});
  add("sim/sensors", {"sim/scene"});

  add("survey", {});
  add("survey/external", {"survey"});
  add("survey/fixed_views", {"survey"});
  add("survey/patterns", {"survey"});
  add("survey/pb_nbv", {"survey"});
  add("survey/inspection", {"survey"});
  add("survey/photo", {"survey", "survey/patterns"});
  add("survey/see", {"survey"});
  add("survey/surfel/raster", {"survey"});
  add("survey/surfel", {"survey", "survey/surfel/raster"});
  add("survey/volumetric", {"survey"});
  add("survey/planners",
      {"survey", "survey/external", "survey/fixed_views", "survey/patterns", "survey/pb_nbv",
       "survey/see", "survey/surfel", "survey/surfel/raster", "survey/volumetric"});

  add("flight/clearance", {});
  add("flight/autopilot", {});
  add("flight/motion", {"flight/clearance", "flight/autopilot"});
  add("flight/paths", {"flight/clearance"});
  add("flight/rtl", {"flight/clearance", "flight/motion", "flight/paths"});
  add("flight/route", {"flight/clearance", "flight/motion", "flight/paths", "flight/rtl"});
  add("flight/export",
      {"flight/clearance", "flight/motion", "flight/paths", "flight/rtl", "flight/route"});
  add("flight/interpreter",
      {"flight/clearance", "flight/autopilot", "flight/motion", "flight/export"});
  add("flight/mavlink", {});
  add("flight/calibration",
      {"flight/clearance", "flight/autopilot", "flight/motion", "flight/export"});
  add("flight/monte_carlo", {"flight/clearance", "flight/autopilot", "flight/motion", "flight/rtl",
                             "flight/interpreter"});
  add("flight/flown",
      {"flight/clearance", "flight/motion", "flight/rtl", "flight/route", "flight/export",
       "flight/interpreter", "flight/calibration", "flight/monte_carlo"});
  add("flight/fleet", {"flight/clearance", "flight/motion", "flight/paths", "flight/rtl",
                       "flight/route", "flight/monte_carlo"});
  add("flight/district", {"flight/clearance", "flight/motion", "flight/rtl", "flight/route"});
  add("flight", {"flight/clearance", "flight/motion", "flight/autopilot", "flight/paths",
                 "flight/rtl", "flight/route", "flight/export", "flight/interpreter",
                 "flight/monte_carlo", "flight/flown", "flight/fleet"});

  // Modules of each library below missions/.
  std::map<std::string, std::vector<std::string>> modules_in;
  for (const auto& [module_name, others] : modules) {
    modules_in[module_name.substr(0, module_name.find('/'))].push_back(module_name);
  }
  // Adds a library of missions/ with its folders, each of which may use the previous ones.
  // `outside` are the libraries outside missions/ that it uses in addition to geometry, `inside`
  // those of missions/.
  const auto add_library = [&](const std::vector<std::string>& folders,
                               const std::vector<std::string>& outside,
                               const std::vector<std::string>& inside) {
    std::vector<std::string> all{"missions"};  // version.h only
    for (const std::string& library : outside) {
      all.insert(all.end(), modules_in[library].begin(), modules_in[library].end());
    }
    for (const std::string& library : inside) {
      const auto& own = modules_in["missions/" + library];
      all.insert(all.end(), own.begin(), own.end());
    }
    const std::string name = folders.front().substr(0, folders.front().find('/'));
    for (const std::string& folder : folders) {
      const std::string module_name = "missions/" + folder;
      add(module_name, all);
      all.push_back(module_name);
      modules_in["missions/" + name].push_back(module_name);
    }
  };
  add_library({"support"}, {"geometry"}, {});
  add_library({"site_data/formats", "site_data"}, {"flight"}, {"support"});
  add_library({"scene"}, {"sim", "flight"}, {"site_data", "support"});
  add_library({"session"}, {"survey", "flight"}, {"support"});
  add_library({"evaluation"}, {"sim", "survey", "flight"},
              {"scene", "session", "site_data", "support"});
  add_library({"simulation"}, {"sim", "survey", "flight"},
              {"evaluation", "scene", "session", "support"});
  add_library({"scan"}, {"sim", "flight"}, {"scene", "support"});
  add_library({"online/live", "online/guided", "online/recordings"}, {"survey", "flight"},
              {"session", "support"});
  add_library(
      {"config"}, {"sim", "survey", "flight"},
      {"online", "scan", "simulation", "evaluation", "session", "scene", "site_data", "support"});
  add_library(
      {"package/fleet", "package/replan", "package/verification", "package"},
      {"sim", "survey", "flight"},
      {"config", "scan", "simulation", "evaluation", "session", "scene", "site_data", "support"});
  add_library({"wizard"}, {"flight"}, {"config", "site_data", "support"});
  add_library({"photo"}, {"sim", "survey", "flight"},
              {"package", "wizard", "config", "scan", "simulation", "evaluation", "session",
               "scene", "site_data", "support"});
  add_library({"inspection"}, {"sim", "survey", "flight"},
              {"package", "wizard", "config", "scan", "simulation", "evaluation", "session",
               "scene", "site_data", "support"});
  add_library({"comparison"}, {"sim", "survey", "flight"},
              {"photo", "package", "config", "scan", "simulation", "evaluation", "session", "scene",
               "site_data", "support"});
  add_library({"report"}, {"sim", "survey", "flight"},
              {"package", "config", "scan", "simulation", "evaluation", "session", "scene",
               "site_data", "support"});
  add_library({"batch/benchmark", "batch/campaign", "batch/district"}, {"sim", "survey", "flight"},
              {"package", "wizard", "config", "simulation", "evaluation", "session", "scene",
               "site_data", "support"});
  add_library({"api"}, {"sim", "survey", "flight"},
              {"package", "config", "scan", "simulation", "evaluation", "session", "scene",
               "site_data", "support"});
  add_library({"studio"}, {}, {"config", "online", "simulation", "support"});
  add_library({"cli", "cli/clouds"}, {"sim", "survey", "flight"},
              {"studio", "report", "batch", "photo", "inspection", "comparison", "wizard",
               "package", "config", "online", "scan", "simulation", "evaluation", "session",
               "scene", "site_data", "support"});
  // Like a user of the library: public headers only.
  add("python",
      {"sim/models", "sim/sensors", "survey", "flight/clearance", "flight/route", "missions/api"});
  return modules;
}

std::vector<SourceFile> product() {
  return read_sources(SKYCAP_SOURCE_DIR,
                      {"geometry", "sim", "survey", "flight", "missions", "python"});
}

/// Returns the product sources and those of other folders.
std::vector<SourceFile> all_sources() {
  return read_sources(SKYCAP_SOURCE_DIR, {"mathematics", "geometry", "sim", "survey", "flight",
                                          "missions", "python", "library", "clients", "tests"});
}

TEST(Modules, HaveNoCyclicOrForbiddenIncludes) {
  EXPECT_THAT(forbidden_includes(product(), architecture()), IsEmpty());
  EXPECT_THAT(circular_modules(architecture()), IsEmpty());
  EXPECT_THAT(circular_headers(product()), IsEmpty());
}

TEST(Modules, KeepHeavyHeadersInSources) {
  EXPECT_THAT(heavy_headers(product(), {"CGAL/", "pcl/", "mrpt/", "ompl/", "embree3/", "gdal",
                                        "ogr", "cpl_", "ceres/", "nlopt", "httplib"}),
              IsEmpty());
}

TEST(Sources, DrawRandomNumbersInDefinedOrder) {
  EXPECT_THAT(unordered_draws(SKYCAP_SOURCE_DIR, all_sources()), IsEmpty());
}

/// Meshes are ground truth. Measured points are not.
TEST(Modules, HideGroundTruthFromPlanners) {
  for (const SourceFile& source : testing_support::not_empty(product())) {
    // Photo planning uses prior data, which are meshes.
    if (!source.path.starts_with("survey/") || source.path.starts_with("survey/photo/")) continue;
    EXPECT_THAT(source.own, testing::Not(testing::Contains(HasSubstr("surfaces/mesh"))))
        << source.path;
  }
}

/// A tree with an upper and a lower module, in which each test plants a fault.
class ArchitectureCheck : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) {
    const std::filesystem::path file = folder_.path() / path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  std::vector<SourceFile> sources() const { return read_sources(folder_.path(), {"house"}); }
  std::filesystem::path root() const { return folder_.path(); }

  const Modules modules_ = {{"house/lower", {}}, {"house/upper", {"house/lower"}}};

 private:
  testing_support::TemporaryFolder folder_;
};

TEST_F(ArchitectureCheck, DetectsForbiddenIncludes) {
  write("house/upper/roof.h", "#include \"house/lower/floor.h\"\n");
  write("house/lower/floor.h", "");
  EXPECT_THAT(forbidden_includes(sources(), modules_), IsEmpty());
  write("house/lower/floor.cpp", "#include \"house/upper/roof.h\"\n");
  EXPECT_THAT(forbidden_includes(sources(), modules_),
              ElementsAre("house/lower/floor.cpp: house/lower may not use house/upper/roof.h"));
}

TEST_F(ArchitectureCheck, DetectsFilesWithoutModule) {
  write("house/shed/tool.h", "");
  EXPECT_THAT(forbidden_includes(sources(), modules_), ElementsAre(HasSubstr("in no room")));
}

TEST_F(ArchitectureCheck, DetectsCycles) {
  write("house/lower/egg.h", "#include \"house/lower/hen.h\"\n");
  write("house/lower/hen.h", "#include \"house/lower/egg.h\"\n");
  EXPECT_THAT(circular_headers(sources()), ElementsAre("house/lower/egg.h", "house/lower/hen.h"));
  EXPECT_THAT(circular_modules({{"a", {"b"}}, {"b", {"c"}}, {"c", {"a"}}}),
              ElementsAre("a", "b", "c"));
}

TEST_F(ArchitectureCheck, DetectsHeavyHeadersInHeadersOnly) {
  write("house/lower/tree.cpp", "#include <CGAL/Kd_tree.h>\n");
  EXPECT_THAT(heavy_headers(sources(), {"CGAL/"}), IsEmpty());
  write("house/lower/tree.h", "#include <CGAL/Kd_tree.h>\n");
  EXPECT_THAT(heavy_headers(sources(), {"CGAL/"}), ElementsAre(HasSubstr("house/lower/tree.h")));
}

TEST_F(ArchitectureCheck, DetectsSeveralDrawsInOneCall) {
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

}  // namespace
}  // namespace skycap::structure
