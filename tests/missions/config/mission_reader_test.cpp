#include "missions/config/mission_reader.h"

#include <map>
#include <numbers>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/config/mission_keys.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double degree = geometry::radians_per_degree;

const std::string smallest =
    "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.005}\n";

config::MissionDocument parsed(const std::string& more,
                               const std::vector<config::KeyOverride>& overrides = {}) {
  return config::parse_mission_document(smallest + more, "some/folder/vase.yaml", overrides);
}

std::string complaint(const std::string& text,
                      const std::vector<config::KeyOverride>& overrides = {}) {
  return testing_support::complaint_of(
      [&] { config::parse_mission_document(text, "m.yaml", overrides); });
}

TEST(MissionReader, NeedsOnlyAModelAndARegistrationDistance) {
  const config::MissionDocument mission = parsed("");
  EXPECT_EQ(mission.name, "vase");
  EXPECT_EQ(mission.scene.model, "builtin:teapot");
  EXPECT_EQ(mission.evaluation.registration_distance, 0.005);
  EXPECT_TRUE(mission.planner.see.optimise_views);
}

TEST(MissionReader, TurnsDegreesIntoRadians) {
  const config::MissionDocument mission =
      parsed("sensor: {horizontal_fov_deg: 90}\nplanner: {name: see}\n", {});
  EXPECT_DOUBLE_EQ(mission.sensor.options.camera.camera.horizontal_fov, 0.5 * std::numbers::pi);
}

/// Two values that a key takes; `is_second` says which.
config::KeyValue value_for(const config::Key& key, bool is_second) {
  switch (key.type) {
    case config::KeyType::text:
      if (key.path == "scene.model") {  // of drawn models, which have a level of detail and a seed
        return std::string("builtin:") + (is_second ? "city-block" : "church");
      }
      return std::string(is_second ? "/some/tile.yaml" : "/some/other.yaml");
    case config::KeyType::boolean:
      return is_second;
    case config::KeyType::choice:
      return is_second ? key.choices.back() : key.choices.front();
    case config::KeyType::integer:
      return std::int64_t{is_second ? 7 : 3};
    case config::KeyType::vector:
      return Vector3d(is_second ? Vector3d(1, 2, 3) : Vector3d(4, -2, 8));
    case config::KeyType::number:
      return is_second ? 0.25 : 0.5;
    case config::KeyType::polygon:
      return std::vector<Eigen::Vector2d>{{0, 0}, {9, 0}, {0, is_second ? 9.5 : 4.5}};
    case config::KeyType::volumes:
      return std::vector<geometry::Prism>{
          {"", {{0, 0}, {1, 0}, {0, 1}}, -2.0, is_second ? 30.0 : 60.0}};
    case config::KeyType::vectors:
      return std::vector<Vector3d>{{10, -20, 90}, {is_second ? 0.5 : 2.5, 0, -45}};
    case config::KeyType::sources:
      return std::vector<site_data::Source>{
          {.file = is_second ? "/tile.gml" : "/map.gml", .role = site_data::Role::terrain}};
    case config::KeyType::texts:
      return std::vector<std::string>{"m350_rtk", is_second ? "mavic_3e" : "generic"};
    case config::KeyType::integers:
      return std::vector<int>{2, is_second ? 6 : 5};
    case config::KeyType::pairs:
      return std::map<std::string, std::string>{{"use", is_second ? "church" : "mill"}};
  }
  return {};
}

std::string text_of(const config::Key& key, const config::MissionDocument& document) {
  const auto value = key.get(document);
  return value ? config::to_text(*value) : "-";
}

/// A key that has no value unless another has a certain one, and that other one.
const std::map<std::string, std::string> means_nothing_without = {
    {"sensor.frame_period", "sensor.capture"}};

/// Each key has a field of its own: setting it changes its text, to that of the value, and no other
/// key's. `document` has room for the keys: a source of prior data for those of sources.
void expect_own_fields(std::span<const config::Key> keys, config::MissionDocument document) {
  for (const config::Key& key : keys) key.set(document, value_for(key, true));
  for (const config::Key& key : keys) {
    EXPECT_EQ(text_of(key, document), config::to_text(value_for(key, true))) << key.path;
    config::MissionDocument changed = document;
    key.set(changed, value_for(key, false));
    EXPECT_EQ(text_of(key, changed), config::to_text(value_for(key, false))) << key.path;
    EXPECT_NE(text_of(key, changed), text_of(key, document)) << key.path << " is not changed";
    for (const config::Key& other : keys) {
      const auto needed = means_nothing_without.find(other.path);
      if (&other == &key) continue;
      if (needed != means_nothing_without.end() && needed->second == key.path) continue;
      EXPECT_EQ(text_of(other, changed), text_of(other, document))
          << other.path << " changes with " << key.path;
    }
  }
}

TEST(MissionReader, GivesEachKeyAFieldOfItsOwn) { expect_own_fields(config::mission_keys(), {}); }

TEST(MissionReader, GivesEachKeyOfASourceAFieldOfItsOwn) {
  config::MissionDocument document;
  document.prior.emplace_back();
  expect_own_fields(config::find_key("prior")->items, std::move(document));
}

// Two keys that have each other's field would pass the tests above. Here and below are those that
// are easily mistaken for each other, with their values where they belong.
TEST(MissionReader, PutsKeysOfSensorAndPlannerIntoTheirOwnFields) {
  const config::MissionDocument document = parsed(
      "sensor: {width: 30, height: 20, horizontal_fov_deg: 60, vertical_fov_deg: 40,\n"
      "         min_range: 1, max_range: 9, exposure: 0.02, readout: 0.03, settle: 0.4}\n"
      "planner: {density: 300, resolution_radius: 0.3, spacing: 0.04, view_distance: 5,\n"
      "          scene_box: {min: [1, 2, 3], max: [4, 5, 6]}, occlusion_radius: 0.6,\n"
      "          occlusion_search_distance: 7, occluder_spacing: 0.8, frontier_spacing: 0.9,\n"
      "          target_coverage: 0.7, min_gain: 0.002}\n"
      "volumetric: {window_begin: 0.1, window_end: 0.8, ray_depth: 11, shadow_length: 12}\n");
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  EXPECT_EQ(sensor.camera.camera.width, 30);
  EXPECT_EQ(sensor.camera.camera.height, 20);
  EXPECT_DOUBLE_EQ(sensor.camera.camera.horizontal_fov, 60.0 * degree);
  EXPECT_DOUBLE_EQ(sensor.camera.camera.vertical_fov, 40.0 * degree);
  EXPECT_EQ(sensor.camera.camera.min_range, 1.0);
  EXPECT_EQ(sensor.camera.camera.max_range, 9.0);
  EXPECT_EQ(sensor.shutter.exposure, 0.02);
  EXPECT_EQ(sensor.shutter.readout, 0.03);
  EXPECT_EQ(sensor.settle, 0.4);
  const config::SamplingSection& sampling = document.planner.sampling;
  EXPECT_EQ(sampling.density, 300.0);
  EXPECT_EQ(sampling.resolution_radius, 0.3);
  EXPECT_EQ(sampling.spacing, 0.04);
  EXPECT_EQ(sampling.view_distance, 5.0);
  EXPECT_EQ(sampling.scene_box.value().min(), Vector3d(1, 2, 3));
  EXPECT_EQ(sampling.scene_box.value().max(), Vector3d(4, 5, 6));
  EXPECT_EQ(document.planner.see.occlusion_radius, 0.6);
  EXPECT_EQ(document.planner.see.occlusion_search_distance, 7.0);
  EXPECT_EQ(document.planner.see.occluder_spacing, 0.8);
  EXPECT_EQ(document.planner.see.frontier_spacing, 0.9);
  EXPECT_EQ(document.planner.skycap_stop.wanted_coverage, 0.7);
  EXPECT_EQ(document.planner.skycap_stop.least_gain, 0.002);
  EXPECT_EQ(document.planner.volumetric.rays.window_begin, 0.1);
  EXPECT_EQ(document.planner.volumetric.rays.window_end, 0.8);
  EXPECT_EQ(document.planner.volumetric.ray_depth, 11.0);
  EXPECT_EQ(document.planner.volumetric.shadow_length, 12.0);
}

TEST(MissionReader, PutsKeysOfPlaceAndLimitsIntoTheirOwnFields) {
  const config::MissionDocument document = parsed(
      "start: {position: [1, 1, 1], look_at: [2, 2, 2], direction: [3, 3, 3]}\n"
      "limits: {max_distance: 100, max_minutes: 20, stand_off: 3, ground_clearance: 4,\n"
      "         min_pitch_deg: -60, max_pitch_deg: 30, speed: 6, time_per_view: 8}\n"
      "site: {min_height: 1, max_height: 99, latitude_deg: 51, longitude_deg: -1,\n"
      "       ellipsoid_height: 120, geoid_undulation: 47}\n"
      "live: {pose_sigma: 0.3, pose_sigma_deg: 2}\n"
      "paper: {views: 1, coverage: 0.5, planning_time: 3, distance: 4}\n");
  EXPECT_EQ(document.start.position, Vector3d(1, 1, 1));
  EXPECT_EQ(document.start.look_at, Vector3d(2, 2, 2));
  EXPECT_EQ(document.start.direction, Vector3d(3, 3, 3));
  const config::LimitsSection& limits = document.limits;
  EXPECT_EQ(limits.options.max_distance, 100.0);
  EXPECT_EQ(limits.max_minutes, 20.0);
  EXPECT_EQ(limits.stand_off, 3.0);
  EXPECT_EQ(limits.ground_clearance, 4.0);
  EXPECT_DOUBLE_EQ(limits.lowest_pitch, -60.0 * degree);
  EXPECT_DOUBLE_EQ(limits.highest_pitch, 30.0 * degree);
  EXPECT_EQ(limits.options.speed, 6.0);
  EXPECT_EQ(limits.options.time_per_view, 8.0);
  EXPECT_EQ(document.site.lowest_height, 1.0);
  EXPECT_EQ(document.site.highest_height, 99.0);
  EXPECT_EQ(document.georeference.latitude_deg, 51.0);
  EXPECT_EQ(document.georeference.longitude_deg, -1.0);
  EXPECT_EQ(document.georeference.ellipsoid_height, 120.0);
  EXPECT_EQ(document.georeference.geoid_undulation, 47.0);
  EXPECT_EQ(document.live.pose_sigma, 0.3);
  EXPECT_DOUBLE_EQ(document.live.pose_sigma_angle, 2.0 * degree);
  EXPECT_EQ(document.paper.views, 1.0);
  EXPECT_EQ(document.paper.coverage, 0.5);
  EXPECT_EQ(document.paper.planning_time, 3.0);
  EXPECT_EQ(document.paper.distance, 4.0);
}

TEST(MissionReader, PutsKeysOfFlightsIntoTheirOwnFields) {
  const config::MissionDocument document = parsed(
      "flight: {clearance: 3, position_error: 0.2, tracking_error: 0.4, map_error: 0.6,\n"
      "         unknown_box: {min: [1, 2, 3], max: [4, 5, 6]}, takeoff: [7, 8, 9],\n"
      "         takeoff_climb: 10, pad_slope_deg: 2, max_pad_slope_deg: 12, cruise_speed: 5,\n"
      "         hold: 0.7, hold_after: 0.9, wind_speed: 6, wind_from_deg: 270,\n"
      "         battery_temperature: -5, reserve: 0.3, vehicles: [generic, m350_rtk], separation: "
      "14,\n"
      "         timing_tolerance: 16}\n");
  const flight::FlightOptions& flight = document.flight.options;
  EXPECT_EQ(flight.clearance, 3.0);
  EXPECT_EQ(flight.position_error, 0.2);
  EXPECT_EQ(flight.tracking_error, 0.4);
  EXPECT_EQ(flight.map_error, 0.6);
  EXPECT_EQ(document.flight.unknown_box.value().min(), Vector3d(1, 2, 3));
  EXPECT_EQ(document.flight.unknown_box.value().max(), Vector3d(4, 5, 6));
  EXPECT_EQ(flight.takeoff, Vector3d(7, 8, 9));
  EXPECT_EQ(flight.takeoff_climb, 10.0);
  EXPECT_DOUBLE_EQ(flight.pad_slope.value(), 2.0 * degree);
  EXPECT_DOUBLE_EQ(flight.steepest_pad, 12.0 * degree);
  EXPECT_EQ(flight.cruise_speed, 5.0);
  EXPECT_EQ(flight.hold, 0.7);
  EXPECT_EQ(flight.hold_after, 0.9);
  EXPECT_EQ(flight.wind_speed, 6.0);
  EXPECT_DOUBLE_EQ(flight.wind_from, 270.0 * degree);
  EXPECT_EQ(flight.temperature, -5.0);
  EXPECT_EQ(flight.reserve, 0.3);
  EXPECT_EQ(flight.fleet.separation, 14.0);
  EXPECT_EQ(flight.fleet.timing_tolerance, 16.0);
}

TEST(MissionReader, PutsKeysOfScansIntoTheirOwnFields) {
  const config::MissionDocument document = parsed(
      "scan:\n"
      "  orbit: {centre: [1, 2, 3], radius: 40, min_height: 5, max_height: 60, circles: 7, speed: "
      "8,\n"
      "          start_deg: 90}\n"
      "  speed: 9\n"
      "  mount: {position: [0.1, 0.2, 0.3], rotation_deg: [10, 20, 30]}\n"
      "  navigation: {horizontal_sigma: 0.01, vertical_sigma: 0.02, tilt_sigma_deg: 1,\n"
      "               heading_sigma_deg: 2, correlation_time: 60}\n"
      "  lever_arm_error: [0.4, 0.5, 0.6]\n"
      "  boresight_error_deg: [1, 2, 3]\n"
      "  frame_period: 0.5\n"
      "  depth_unit: 0.25\n");
  const scan::FlownScanOptions& scan = document.scan;
  EXPECT_EQ(scan.orbit.centre, Vector3d(1, 2, 3));
  EXPECT_EQ(scan.orbit.radius, 40.0);
  EXPECT_EQ(scan.orbit.lowest, 5.0);
  EXPECT_EQ(scan.orbit.highest, 60.0);
  EXPECT_EQ(scan.orbit.circles, 7);
  EXPECT_EQ(scan.orbit.speed, 8.0);
  EXPECT_DOUBLE_EQ(scan.orbit.start, 90.0 * degree);
  EXPECT_EQ(scan.speed, 9.0);
  EXPECT_EQ(scan.mount_position, Vector3d(0.1, 0.2, 0.3));
  EXPECT_TRUE(scan.mount_rotation.isApprox(degree * Vector3d(10, 20, 30)));
  EXPECT_EQ(scan.navigation.horizontal_sigma, 0.01);
  EXPECT_EQ(scan.navigation.vertical_sigma, 0.02);
  EXPECT_DOUBLE_EQ(scan.navigation.tilt_sigma, 1.0 * degree);
  EXPECT_DOUBLE_EQ(scan.navigation.heading_sigma, 2.0 * degree);
  EXPECT_EQ(scan.navigation.correlation_time, 60.0);
  EXPECT_EQ(scan.lever_arm_error, Vector3d(0.4, 0.5, 0.6));
  EXPECT_TRUE(scan.boresight_error.isApprox(degree * Vector3d(1, 2, 3)));
  EXPECT_EQ(scan.frame_period, 0.5);
  EXPECT_EQ(scan.depth_unit, 0.25);
}

TEST(MissionReader, TakesPresetsFirstWhereverTheyStand) {
  const config::MissionDocument mission = parsed(
      "sensor: {width: 600, preset: high_resolution}\nplanner: {visibility_graph: true, name: "
      "see}\n");
  EXPECT_EQ(mission.sensor.options.camera.camera.width, 600);
  EXPECT_EQ(mission.sensor.options.camera.camera.height, 1750);
  EXPECT_TRUE(mission.planner.see.visibility_graph);
  EXPECT_FALSE(mission.planner.see.optimise_views);
}

TEST(MissionReader, LetsOverridesReplaceKeysAndNamesTheirOrigin) {
  const config::MissionDocument mission = parsed("seed: 3\n", {{"--seed", "seed", "8"}});
  EXPECT_EQ(mission.seed, 8U);
  EXPECT_EQ(complaint(smallest, {{"--seed", "seed", "many"}}),
            "--seed: key seed is many; it must be an integer from 0 to 1e+15");
  EXPECT_THAT(complaint(smallest, {{"--set", "planner.densty", "1"}}),
              HasSubstr("did you mean planner.density?"));
}

TEST(MissionReader, SuggestsTheKeyInItsRightSection) {
  EXPECT_EQ(complaint(smallest + "sensor:\n  sigma: 0.1\n"),
            "m.yaml:4: key sensor.sigma is unknown; did you mean sensor.noise.sigma?");
  EXPECT_THAT(complaint(smallest + "colour_of_the_sky: blue\n"),
              HasSubstr("expected one of: name, seed, threads, scene, sensor, planner, volumetric, "
                        "start, limits, evaluation, paper, site, flight, scan"));
}

// The parser must survive what people and fuzzers write: here, every prefix of a valid mission and
// every single damaged byte of it either parses or is refused in one line.
TEST(MissionReader, RefusesDamagedFilesInOneLine) {
  const std::string whole =
      "scene:\n  model: builtin:teapot  # a comment\n  position: [1, 2.5, -3e1]\n"
      "evaluation: {coverage_distance: 0.005}\nname: \"a\\tb\"\nsensor: {preset: 'd435'}\n";
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
