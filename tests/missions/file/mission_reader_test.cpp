#include "missions/file/mission_reader.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/derived/site.h"
#include "missions/file/mission_keys.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;

const std::string smallest =
    "scene: {model: 'builtin:teapot'}\nevaluation: {registration_distance: 0.005}\n";

file::Mission parsed(const std::string& more,
                     const std::vector<file::KeyOverride>& overrides = {}) {
  return file::parse_mission(smallest + more, "some/folder/vase.yaml", overrides);
}

std::string complaint(const std::string& text,
                      const std::vector<file::KeyOverride>& overrides = {}) {
  try {
    file::parse_mission(text, "m.yaml", overrides);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MissionReader, NeedsOnlyAModelAndARegistrationDistance) {
  const file::Mission mission = parsed("");
  EXPECT_EQ(mission.name, "vase");
  EXPECT_EQ(mission.scene.model, "builtin:teapot");
  EXPECT_EQ(mission.evaluation.registration_distance, 0.005);
  EXPECT_TRUE(mission.planner.see.optimise_views);
}

TEST(MissionReader, TurnsDegreesIntoRadians) {
  const file::Mission mission =
      parsed("sensor: {horizontal_fov_deg: 90}\nplanner: {name: see}\n", {});
  EXPECT_DOUBLE_EQ(mission.sensor.camera.camera.horizontal_fov, 0.5 * std::numbers::pi);
}

TEST(MissionReader, SetsEachKeyToWhatItGivesBack) {
  file::Mission mission;
  for (const file::Key& key : file::mission_keys()) {
    file::KeyValue value;
    switch (key.type) {
      case file::KeyType::text:
        value = std::string("builtin:teapot");
        break;
      case file::KeyType::boolean:
        value = true;
        break;
      case file::KeyType::choice:
        value = key.choices.back();
        break;
      case file::KeyType::integer:
        value = std::int64_t{7};
        break;
      case file::KeyType::vector:
        value = Eigen::Vector3d(1, 2, 3);
        break;
      case file::KeyType::number:
        value = 0.25;
        break;
      case file::KeyType::polygon:
        value = std::vector<Eigen::Vector2d>{{0, 0}, {9, 0}, {0, 9.5}};
        break;
      case file::KeyType::volumes:
        value = std::vector<geometry::Prism>{{"", {{0, 0}, {1, 0}, {0, 1}}, -2.0, 30.0}};
        break;
      case file::KeyType::vectors:
        value = std::vector<Eigen::Vector3d>{{10, -20, 90}, {0.5, 0, -45}};
        break;
    }
    key.set(mission, value);
    const auto back = key.get(mission);
    ASSERT_TRUE(back) << key.path;
    EXPECT_EQ(file::to_text(*back), file::to_text(value)) << key.path;
  }
}

TEST(MissionReader, TakesPresetsFirstWhereverTheyStand) {
  const file::Mission mission = parsed(
      "sensor: {width: 600, preset: high_resolution}\nplanner: {visibility_graph: true, name: "
      "see}\n");
  EXPECT_EQ(mission.sensor.camera.camera.width, 600);
  EXPECT_EQ(mission.sensor.camera.camera.height, 1750);
  EXPECT_TRUE(mission.planner.see.visibility_graph);
  EXPECT_FALSE(mission.planner.see.optimise_views);
}

// spec: psi = d, one frontier a twentieth of d, occluders 2 r apart, tau above the number of
// clusters.
TEST(MissionReader, DerivesTheBuildingPresetFromTheSensorAndTheDensity) {
  const std::string building =
      "sensor: {preset: high_resolution}\n"
      "planner: {preset: building, density: 213, resolution_radius: 0.15";
  const survey::see::SeeConfig see = parsed(building + "}").planner.see;
  EXPECT_NEAR(see.occlusion_search_distance, 41.29, 5e-3);  // d, as published
  EXPECT_NEAR(see.frontier_spacing, 2.0645, 5e-4);
  EXPECT_DOUBLE_EQ(see.occluder_spacing, 0.3);
  EXPECT_EQ(see.visibility_update_limit, 1000U);
  EXPECT_TRUE(see.drop_if_still_occluded);

  const survey::see::SeeConfig overridden =
      parsed(building + ", occlusion_search_distance: 10, visibility_update_limit: 5}").planner.see;
  EXPECT_EQ(overridden.occlusion_search_distance, 10.0);
  EXPECT_EQ(overridden.visibility_update_limit, 5U);
  EXPECT_NEAR(overridden.frontier_spacing, 2.0645, 5e-4);
}

TEST(MissionReader, ReadsTheSitesAirspace) {
  const file::Mission mission = parsed(
      "site:\n"
      "  geofence: [[-50, -40], [50, -40], [50.5, 40]]\n"
      "  no_fly:\n"
      "    - {corners: [[0, 0], [5, 0], [0, 5]], bottom: 0, top: 30}\n"
      "  lowest_height: 3\n"
      "  highest_height: 120\n"
      "limits: {ground_clearance: 5, stand_off: 2, lowest_pitch_deg: -90, highest_pitch_deg: "
      "30}\n");
  const survey::ViewLimits limits = derived::view_limits(mission);
  ASSERT_EQ(limits.geofence.size(), 3U);
  EXPECT_EQ(limits.geofence[2], Eigen::Vector2d(50.5, 40.0));
  ASSERT_EQ(limits.no_fly.size(), 1U);
  EXPECT_EQ(limits.no_fly[0].footprint[1], Eigen::Vector2d(5.0, 0.0));
  EXPECT_EQ(limits.no_fly[0].ceiling, 30.0);
  EXPECT_EQ(limits.least_height, 5.0);  // the higher of the two
  EXPECT_EQ(limits.most_height, 120.0);
  EXPECT_EQ(limits.stand_off, 2.0);
  EXPECT_NEAR(limits.most_pitch, 0.5235988, 1e-6);
  EXPECT_NO_THROW(limits.validate());
}

TEST(MissionReader, RefusesAirspacesThatCannotBe) {
  EXPECT_THAT(complaint("site: {geofence: [[0, 0], [1, 0]]}"), HasSubstr("three or more corners"));
  EXPECT_THAT(complaint("site: {geofence: [[0, 0], [1, 0], [1, x]]}"), HasSubstr("site.geofence"));
  const std::string corners = "corners: [[0, 0], [1, 0], [0, 1]]";
  EXPECT_THAT(complaint("site: {no_fly: [{" + corners + ", bottom: 3, top: 3}]}"),
              HasSubstr("site.no_fly"));
  EXPECT_THAT(complaint("site: {no_fly: [{" + corners + ", bottom: 0, roof: 3}]}"),
              HasSubstr("a list of {corners, bottom, top}"));
  EXPECT_THAT(parsed("site: {no_fly: []}").site.no_fly, testing::IsEmpty());
  EXPECT_THAT(complaint(std::string(smallest) + "site: {lowest_height: 5, highest_height: 5}"),
              HasSubstr("site.highest_height: is not above"));
  EXPECT_THAT(
      complaint(std::string(smallest) + "limits: {lowest_pitch_deg: 9, highest_pitch_deg: -9}"),
      HasSubstr("limits.highest_pitch_deg: is not above"));
}

TEST(MissionReader, MeasuresTheGroundClearanceFromTheScenesBase) {
  const file::Mission mission = file::parse_mission(
      "scene: {model: 'builtin:teapot', position: [0, 0, 60]}\n"
      "evaluation: {registration_distance: 0.005}\nlimits: {ground_clearance: 2}\n",
      "m.yaml");
  EXPECT_EQ(mission.planner.see.least_height, 62.0);
}

TEST(MissionReader, LetsOverridesReplaceKeysAndNamesTheirOrigin) {
  const file::Mission mission = parsed("seed: 3\n", {{"--seed", "seed", "8"}});
  EXPECT_EQ(mission.seed, 8U);
  EXPECT_EQ(complaint(smallest, {{"--seed", "seed", "many"}}),
            "--seed: key seed: is many; give a whole number from 0 to 1e+15");
  EXPECT_THAT(complaint(smallest, {{"--set", "planner.densty", "1"}}),
              HasSubstr("did you mean planner.density?"));
}

TEST(MissionReader, WhatFliesIsPlannedBySkycapUnlessTheMissionSaysOtherwise) {
  const std::string flown = smallest +
                            "flight: {vehicle: generic, unknown_box: {min: [0, 0, 0], "
                            "max: [1, 1, 1]}}\n";
  EXPECT_EQ(file::parse_mission(smallest, "m.yaml").planner.name, file::PlannerName::see_plus_plus);
  EXPECT_EQ(file::parse_mission(flown, "m.yaml").planner.name, file::PlannerName::skycap);
  EXPECT_EQ(file::parse_mission(flown + "planner: {name: see}\n", "m.yaml").planner.name,
            file::PlannerName::see);
}

TEST(MissionReader, SuggestsTheKeyInItsRightSection) {
  EXPECT_EQ(complaint(smallest + "sensor:\n  sigma: 0.1\n"),
            "m.yaml:4: key sensor.sigma: is unknown; did you mean sensor.noise.sigma?");
  EXPECT_THAT(complaint(smallest + "colour_of_the_sky: blue\n"),
              HasSubstr("known are name, seed, threads, scene, sensor, planner, volumetric, "
                        "start, limits, evaluation, paper, site, flight, scan"));
}

// The parser must survive what people and fuzzers write: here, every prefix of a valid mission and
// every single damaged byte of it either parses or is refused in one line.
TEST(MissionReader, RefusesDamagedFilesInOneLine) {
  const std::string whole =
      "scene:\n  model: builtin:teapot  # a comment\n  position: [1, 2.5, -3e1]\n"
      "evaluation: {registration_distance: 0.005}\nname: \"a\\tb\"\nsensor: {preset: 'd435'}\n";
  std::size_t refused = 0;
  const auto try_text = [&](const std::string& text) {
    const std::string message = complaint(text);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    refused += message.empty() ? 0 : 1;
  };
  for (std::size_t length = 0; length < whole.size(); ++length) try_text(whole.substr(0, length));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const char byte : {'\x01', '{', ']', '&', '*', '!', '|', '%', '\xff', '"', '-', '\n'}) {
      std::string damaged = whole;
      damaged[i] = byte;
      try_text(damaged);
    }
  }
  EXPECT_GT(refused, whole.size());
}

TEST(MissionReader, SurvivesDeepNesting) {
  for (const char* bracket : {"[", "{a: ", "- ", "? "}) {
    std::string deep;
    for (int i = 0; i < 20'000; ++i) deep += bracket;
    EXPECT_THAT(complaint(deep), HasSubstr("m.yaml:1: ")) << bracket;
  }
}

}  // namespace
}  // namespace skycap::missions
