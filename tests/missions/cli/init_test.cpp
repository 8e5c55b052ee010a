// init, presets, completion and --version.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/config/mission_document.h"
#include "missions/config/photo_camera_reader.h"
#include "missions/config/resolve.h"
#include "missions/config/sensor_reader.h"
#include "missions/config/vehicle_reader.h"
#include "missions/support/external_program.h"
#include "missions/version.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/site_data/cube_files.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using tests::read_content;
using tests::run_skycap;

TEST(Init, WritesMissionAcceptedByCheck) {
  const tests::TestFolder folder;
  const std::string mission = folder / "teapot.yaml";
  const auto made = run_skycap({"init", "builtin:teapot", "--out", mission});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("skycap check " + mission));
  EXPECT_THAT(read_content(mission), HasSubstr("#"));
  const auto check = run_skycap({"check", mission, "--set", "evaluation.attainable_views=0"});
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
}

// The first view sees the target from outside the unknown space, whatever its shape.
TEST(Init, WritesMissionsThatCanBeSurveyed) {
  const tests::TestFolder folder;
  const std::string house = folder / "house.obj", slab = folder / "slab.obj";
  std::ofstream(house) << testing_support::make_obj({.low = {-5, -5, 0}});
  std::ofstream(slab) << testing_support::make_obj({.low = {-30, -4, 0}, .size = {60, 8, 12}});
  std::size_t number = 0;
  for (const std::string& target : {house, slab, std::string("builtin:teapot")}) {
    for (const std::string sensor : {"intel_d435", "see_high_resolution", "ouster_os1_64"}) {
      for (const std::string vehicle : {"none", "generic", "mavic_3e"}) {
        const std::string mission = folder / (std::to_string(number++) + ".yaml");
        const auto made = run_skycap(
            {"init", target, "--sensor", sensor, "--vehicle", vehicle, "--out", mission});
        ASSERT_EQ(made.exit_code, 0) << made.err;
        const auto check = run_skycap({"check", mission, "--set", "evaluation.attainable_views=0"});
        EXPECT_EQ(check.exit_code, 0) << target << sensor << vehicle << check.out;
      }
    }
  }
}

TEST(Init, SelectsSensorBySize) {
  const tests::TestFolder folder;
  const std::string house = folder / "house.obj", mission = folder / "house.yaml",
                    crate = folder / "crate.yaml";
  std::ofstream(house) << testing_support::make_obj({.low = {-5, -5, 0}});
  ASSERT_EQ(run_skycap({"init", house, "--out", mission}).exit_code, 0);
  EXPECT_THAT(read_content(mission), HasSubstr("lidar: \"ouster_os1_64\""));
  const std::string small = folder / "small.obj";
  std::ofstream(small) << testing_support::make_obj({.low = {-1, -1, 0}, .size = {2, 2, 2}});
  ASSERT_EQ(run_skycap({"init", small, "--out", crate}).exit_code, 0);
  EXPECT_THAT(read_content(crate), HasSubstr("preset: intel_d435"));
}

TEST(Init, RejectsSensorTooShortForVehicle) {
  const tests::TestFolder folder;
  const std::string sensor =
      folder.write("short.yaml",
                   "name: Short\nkind: camera\nwidth_px: 640\nheight_px: 480\n"
                   "horizontal_fov_deg: 60\nvertical_fov_deg: 45\nrange: {min: 0.2, max: 2}\n");
  const auto made = run_skycap({"init", "builtin:radcliffe-camera", "--sensor", sensor, "--vehicle",
                                "mavic_3e", "--out", folder / "m.yaml"});
  EXPECT_EQ(made.exit_code, 2);
  EXPECT_THAT(made.err, HasSubstr("choose a sensor with a longer range"));
}

TEST(Init, WritesMissionsForEverySensorAndVehicle) {
  const tests::TestFolder folder;
  std::size_t number = 0;
  const auto make = [&](const std::string& sensor, const std::string& vehicle) {
    const std::string mission = folder / (std::to_string(number++) + ".yaml");
    const auto made = run_skycap({"init", "builtin:radcliffe-camera", "--sensor", sensor,
                                  "--vehicle", vehicle, "--out", mission});
    ASSERT_EQ(made.exit_code, 0) << sensor << " " << vehicle << ": " << made.err;
    EXPECT_EQ(config::read_mission(mission).flight().has_vehicle(), true);
  };
  for (const std::string_view sensor : config::sensor_presets()) {
    make(std::string(sensor), "generic");
  }
  for (const std::string_view vehicle : config::vehicle_presets()) {
    make("intel_d435", std::string(vehicle));
  }
}

TEST(Init, WritesLiveMissionForRoom) {
  const tests::TestFolder folder;
  const std::string room = folder / "room.yaml", hall = folder / "hall.yaml";
  ASSERT_EQ(run_skycap({"init", "room", "--size", "5", "4", "3", "--out", room}).exit_code, 0);
  const config::MissionSetup setup = config::read_live_mission(room);
  EXPECT_EQ(setup.survey().planner.limits.max_height, 3.0);
  EXPECT_EQ(setup.sensor().camera.camera.width, 848);
  EXPECT_THAT(run_skycap({"next", room, "--survey", folder / "s"}).out, HasSubstr("first scan"));
  const auto narrow = run_skycap({"init", "room", "--vehicle", "generic", "--out", hall});
  EXPECT_EQ(narrow.exit_code, 2);
  EXPECT_THAT(narrow.err, HasSubstr("raise --size or use --vehicle none"));
  const auto wide = run_skycap(
      {"init", "room", "--vehicle", "generic", "--size", "20", "30", "9", "--out", hall});
  ASSERT_EQ(wide.exit_code, 0) << wide.err;
  EXPECT_TRUE(config::read_live_mission(hall).flight().has_vehicle());
  // The vehicle can take off before anything is measured.
  EXPECT_EQ(run_skycap({"check", hall}).exit_code, 0);
  EXPECT_THAT(run_skycap({"next", hall, "--survey", folder / "t"}).out, HasSubstr("view 0: "));
  const auto low = run_skycap({"check", hall, "--set", "site.max_height=5"});
  EXPECT_EQ(low.exit_code, 1);
  EXPECT_THAT(low.out, HasSubstr("problem   the end of the take-off climb"));
  // The useful range of the preset, which measures up to 10 m.
  EXPECT_EQ(setup.sensor().camera.camera.max_range, 3.0);
}

TEST(Init, RejectsOverwritingAndUnknownNames) {
  const tests::TestFolder folder;
  const std::string mission = folder.write("m.yaml", "keep\n");
  EXPECT_EQ(run_skycap({"init", "builtin:teapot", "--out", mission}).exit_code, 2);
  EXPECT_EQ(read_content(mission), "keep\n");
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"builtin:nothing"},
                                             {"builtin:teapot", "--sensor", "nothing"},
                                             {"builtin:teapot", "--vehicle", "nothing"}}) {
    std::vector<std::string> arguments{"init", "--out", folder / "new.yaml"};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(run_skycap(arguments).exit_code, 2);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "new.yaml"));
}

TEST(Init, WritesPhotoMissionForAMesh) {
  const tests::TestFolder folder;
  const std::string mesh = folder / "house.obj", mission = folder / "photos.yaml";
  std::ofstream(mesh) << testing_support::make_obj({.low = {-5, -5, 0}});
  const auto made = run_skycap({"init", mesh, "--sensor", "mavic_3e_wide", "--gsd", "0.005",
                                "--vehicle", "mavic_3e", "--out", mission});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const config::MissionSetup setup = config::read_mission(mission);
  EXPECT_TRUE(setup.document->is_photo());
  EXPECT_EQ(setup.text("photo.gsd"), "0.005");
  EXPECT_EQ(setup.text("flight.free_space"), "assumed");
  EXPECT_NEAR(setup.survey().planner.view_distance, 18.8, 0.1);
  EXPECT_THAT(run_skycap({"init", "builtin:teapot", "--sensor", "mavic_3e_wide", "--gsd", "0.005",
                          "--out", folder / "new.yaml"})
                  .err,
              HasSubstr("photos require a mesh file"));
  EXPECT_THAT(
      run_skycap({"init", mesh, "--sensor", "mavic_3e_wide", "--out", folder / "new.yaml"}).err,
      HasSubstr("set --gsd"));
}

TEST(Presets, ListsVehiclesAndSensorsWithPlausibleValues) {
  const auto json = nlohmann::json::parse(run_skycap({"presets", "--json"}).out);
  EXPECT_EQ(json["vehicles"].size(), config::vehicle_presets().size());
  EXPECT_EQ(json["sensors"].size(), config::sensor_presets().size());
  for (const auto& vehicle : json["vehicles"]) {
    EXPECT_GT(vehicle["endurance_min"], 5.0);
    EXPECT_GT(vehicle["mass_kg"], 0.1);
  }
  const std::string text = run_skycap({"presets"}).out;
  for (const std::string_view name : config::vehicle_presets()) {
    EXPECT_THAT(text, HasSubstr("\n  " + std::string(name) + " "));
  }
  const auto& cameras = json["photo_cameras"];
  EXPECT_EQ(cameras.size(), config::photo_camera_presets().size());
  for (const auto& camera : cameras) EXPECT_GT(camera["min_interval_s"], 0.1) << camera;
  EXPECT_THAT(text,
              HasSubstr("\n  mavic_3e_wide           17.3 x 13 mm   5280 x 3956 px  12.29 mm   "
                        "2.67 mm    0.7 s  mechanical\n"));
  EXPECT_THAT(
      text,
      HasSubstr("intel_d435           depth camera   0.168 to 10 m  0.3 to 3 m  848 x 480 px"));
}

std::string run_in(const std::string& shell, const std::string& script) {
  return support::run_external_program({shell, "-c", script}, ".").output;
}

TEST(Completion, CompletesCommandsAndOptionsInBash) {
  const tests::TestFolder folder;
  const std::string script = folder.write("skycap.bash", run_skycap({"completion", "bash"}).out);
  const auto completed = [&](const std::string& words, int number) {
    return run_in("bash", ". " + script + "; COMP_WORDS=(" + words +
                              ") COMP_CWORD=" + std::to_string(number) +
                              "; compopt() { :; }; _skycap; echo ${COMPREPLY[*]}");
  };
  EXPECT_EQ(completed("skycap pl", 1), "plan\n");
  EXPECT_EQ(completed("skycap plan --max-v", 2), "--max-views\n");
  EXPECT_EQ(completed("skycap check m.yaml --rewr", 3), "--rewrite\n");
}

TEST(Completion, ListsEveryCommandForZshAndFish) {
  const std::string zsh = run_skycap({"completion", "zsh"}).out;
  const std::string fish = run_skycap({"completion", "fish"}).out;
  EXPECT_THAT(zsh, StartsWith("#compdef skycap\n"));
  for (const char* command : {"plan", "init", "presets", "fly-test", "completion"}) {
    EXPECT_THAT(zsh, HasSubstr("\n    '" + std::string(command) + ":"));
    EXPECT_THAT(fish, HasSubstr(" -f -a " + std::string(command) + " -d '"));
  }
  EXPECT_THAT(zsh, HasSubstr("'--max-views=["));
  EXPECT_THAT(fish, HasSubstr("'__fish_seen_subcommand_from plan' -l quiet -d "));
  EXPECT_THAT(fish, HasSubstr("'__fish_seen_subcommand_from plan' -l max-views -r -d "));
  EXPECT_EQ(run_skycap({"completion", "csh"}).exit_code, 2);
}

TEST(Version, NamesCommitCompilerAndBuild) {
  const std::string text = run_skycap({"--version"}).out;
  EXPECT_THAT(text, testing::MatchesRegex("skycap [0-9.]+\ncommit    [0-9a-z]+\\+?\n"
                                          "compiler  [A-Za-z]+ [0-9.]+\nbuild     .+, .+\n"));
  EXPECT_THAT(text, HasSubstr(version));
}

}  // namespace
}  // namespace skycap::missions
