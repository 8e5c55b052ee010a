#include "missions/config/mission_reader.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;

const std::string smallest =
    "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.005}\n";

config::MissionDocument parsed(const std::string& more,
                               const std::vector<config::KeyOverride>& overrides = {}) {
  return config::parse_mission_document(smallest + more, "some/folder/vase.yaml", overrides);
}

std::string error_message(const std::string& text,
                          const std::vector<config::KeyOverride>& overrides = {}) {
  return testing_support::thrown_message(
      [&] { config::parse_mission_document(text, "m.yaml", overrides); });
}

TEST(MissionReader, RequiresOnlyModelAndCoverageDistance) {
  const config::MissionDocument mission = parsed("");
  EXPECT_EQ(mission.name, "vase");
  EXPECT_EQ(mission.scene.model, "builtin:teapot");
  EXPECT_EQ(mission.evaluation.registration_distance, 0.005);
  EXPECT_TRUE(mission.planner.see.optimise_views);
}

TEST(MissionReader, ConvertsDegreesToRadians) {
  const config::MissionDocument mission =
      parsed("sensor: {horizontal_fov_deg: 90}\nplanner: {name: see}\n", {});
  EXPECT_DOUBLE_EQ(mission.sensor.options.camera.camera.horizontal_fov, 0.5 * std::numbers::pi);
}

TEST(MissionReader, AppliesPresetsFirst) {
  const config::MissionDocument mission = parsed(
      "sensor: {width: 600, preset: high_resolution}\nplanner: {visibility_graph: true, name: "
      "see}\n");
  EXPECT_EQ(mission.sensor.options.camera.camera.width, 600);
  EXPECT_EQ(mission.sensor.options.camera.camera.height, 1750);
  EXPECT_TRUE(mission.planner.see.visibility_graph);
  EXPECT_FALSE(mission.planner.see.optimise_views);
}

TEST(MissionReader, TakesAnyCameraPreset) {
  const config::SensorSection real = parsed("sensor: {preset: intel_d435, height: 240}\n").sensor;
  EXPECT_EQ(real.options.camera.camera.max_range, 10.0);
  EXPECT_EQ(real.options.camera.camera.height, 240);
  EXPECT_GT(real.options.camera.stereo.baseline, 0.0);
  EXPECT_EQ(real.options.camera.noise.sigma, 0.0);
  EXPECT_EQ(
      error_message(smallest + "sensor: {preset: velodyne_vlp16}\n"),
      "m.yaml:3: key sensor.preset: velodyne_vlp16 is a LiDAR; set sensor.lidar: velodyne_vlp16 "
      "instead of sensor.preset");
}

// A described sensor does not inherit the useful range of the preset.
TEST(MissionReader, KnowsTheUsefulRangeOfTheNamedCamera) {
  EXPECT_TRUE(parsed("").sensor.useful_range);
  EXPECT_TRUE(parsed("sensor: {preset: d435, width: 320}\n").sensor.useful_range);
  EXPECT_FALSE(parsed("sensor: {width: 320}\n").sensor.useful_range);
  EXPECT_FALSE(parsed("sensor: {preset: d435, max_range: 8}\n").sensor.useful_range);
  EXPECT_FALSE(parsed("sensor: {preset: high_resolution}\n").sensor.useful_range);
}

TEST(MissionReader, AppliesOverridesAndNamesTheirOrigin) {
  const config::MissionDocument mission = parsed("seed: 3\n", {{"--seed", "seed", "8"}});
  EXPECT_EQ(mission.seed, 8U);
  EXPECT_EQ(error_message(smallest, {{"--seed", "seed", "many"}}),
            "--seed: key seed is many; it must be an integer from 0 to 1e+15");
  EXPECT_THAT(error_message(smallest, {{"--set", "planner.densty", "1"}}),
              HasSubstr("did you mean planner.density?"));
}

// YAML: a quoted scalar is a string.
TEST(MissionReader, TellsStringsFromNumbers) {
  EXPECT_EQ(error_message(smallest + "limits: {max_views: 12}\n"), "");
  EXPECT_THAT(error_message(smallest + "limits: {max_views: '12'}\n"),
              HasSubstr("key limits.max_views is the string '12'; it must be an integer"));
  EXPECT_THAT(error_message(smallest + "limits: {max_views: 2.5}\n"),
              HasSubstr("key limits.max_views is 2.5; it must be an integer"));
  EXPECT_THAT(error_message(smallest + "planner: {density: '12'}\n"),
              HasSubstr("key planner.density is the string '12'; it must be "));
}

TEST(MissionReader, SuggestsKeyInCorrectSection) {
  EXPECT_EQ(error_message(smallest + "sensor:\n  sigma: 0.1\n"),
            "m.yaml:4: key sensor.sigma is unknown; did you mean sensor.noise.sigma?");
  EXPECT_THAT(error_message(smallest + "colour_of_the_sky: blue\n"),
              HasSubstr("expected one of: name, seed, threads, scene, sensor, photo, "
                        "inspection, planner, volumetric, uniform, pb_nbv, pattern, start, limits, "
                        "evaluation, paper, site, "
                        "flight, scan"));
}

// Robustness of the parser: each prefix of a valid mission, and the mission with any one byte
// damaged, is parsed or rejected in one line.
TEST(MissionReader, RejectsDamagedFilesInOneLine) {
  const std::string whole =
      "scene:\n  model: builtin:teapot  # a comment\n  position: [1, 2.5, -3e1]\n"
      "evaluation: {coverage_distance: 0.005}\nname: \"a\\tb\"\nsensor: {preset: 'd435'}\n";
  std::size_t rejected = 0;
  const auto try_text = [&](const std::string& text) {
    const std::string message = error_message(text);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    rejected += message.empty() ? 0 : 1;
  };
  for (std::size_t length = 0; length < whole.size(); ++length) try_text(whole.substr(0, length));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char byte : {'\x01', '{', ']', '&', '*', '!', '|', '%', '\xff', '"', '-', '\n'}) {
      std::string damaged = whole;
      damaged[i] = byte;
      try_text(damaged);
    }
  }
  EXPECT_GT(rejected, whole.size());
}

TEST(MissionReader, SurvivesDeepNesting) {
  for (const char* bracket : {"[", "{a: ", "- ", "? "}) {
    std::string deep;
    for (int i = 0; i < 20'000; ++i) deep += bracket;
    EXPECT_THAT(error_message(deep), HasSubstr("m.yaml:1: ")) << bracket;
  }
}

}  // namespace
}  // namespace skycap::missions
