// Missions with standard patterns: random targets, polygons and settings give a verified flight or
// one line that says why not.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/random_numbers.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/simulation/survey_runner.h"
#include "missions/support/number_text.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using geometry::RandomNumbers;
using testing::HasSubstr;
using Json = nlohmann::json;

std::string text(double number) { return support::exact_text(std::round(1e3 * number) / 1e3); }

std::string point(double x, double y) { return "[" + text(x) + ", " + text(y) + "]"; }

/// Draws a number without depending on the order of evaluation.
double draw(RandomNumbers& random, double min, double max) { return random.between(min, max); }

bool draw_flag(RandomNumbers& random, double share) { return draw(random, 0.0, 1.0) < share; }

std::size_t draw_index(RandomNumbers& random, std::size_t count) {
  return std::min(count - 1,
                  static_cast<std::size_t>(draw(random, 0.0, static_cast<double>(count))));
}

/// Returns the OBJ file of one to three boxes on the ground, some of them apart or very thin.
std::string draw_boxes(RandomNumbers& random) {
  std::string vertices, faces;
  const std::size_t count = 1 + draw_index(random, 3);
  for (std::size_t box = 0; box < count; ++box) {
    const double x = draw(random, -10.0, 10.0), y = draw(random, -10.0, 10.0);
    const double width = std::pow(10.0, draw(random, -0.5, 1.1));
    const double depth = std::pow(10.0, draw(random, -0.5, 1.1));
    const double height = std::pow(10.0, draw(random, 0.0, 1.3));
    for (int corner = 0; corner < 8; ++corner) {
      vertices += "v " + text(x + (corner & 1 ? width : 0.0)) + " " +
                  text(y + (corner & 2 ? depth : 0.0)) + " " + text(corner & 4 ? height : 0.0) +
                  "\n";
    }
    constexpr int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& side : sides) {
      faces += "f";
      for (const int corner : side) faces += " " + std::to_string(8 * box + corner + 1);
      faces += "\n";
    }
  }
  return vertices + faces;
}

std::string draw_target(RandomNumbers& random) {
  const double top = draw(random, -1.0, 25.0);
  if (draw_flag(random, 0.5)) return "";
  std::string points;
  const bool is_line = draw_flag(random, 0.5);
  const std::size_t count = (is_line ? 2 : 3) + draw_index(random, 5);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * 3.14159265 * static_cast<double>(i) / static_cast<double>(count);
    const double radius = draw(random, 0.5, 25.0);
    points += (i > 0 ? ", " : "") + point(radius * std::cos(angle), radius * std::sin(angle));
  }
  std::string keys = std::string(is_line ? ", line: [" : ", polygon: [") + points + "]";
  if (draw_flag(random, 0.95)) keys += ", top: " + text(top);
  if (draw_flag(random, 0.3)) keys += ", base: " + text(draw(random, -2.0, 5.0));
  if (is_line && draw_flag(random, 0.5)) keys += ", width: " + text(draw(random, 0.0, 8.0));
  return keys;
}

/// Rotating scanner with few rays.
constexpr const char* small_lidar =
    "name: small\nkind: spinning\ncolumns_per_turn: 180\nrotation_rate_hz: 10\n"
    "channels: {count: 16, lowest_deg: -20, highest_deg: 20}\nrange: {min: 0.1, max: 60}\n"
    "errors: {sigma: 0.01}\n";

/// Returns a random mission with a pattern around boxes in `model`.
std::string draw_mission(RandomNumbers& random, const std::string& model) {
  constexpr const char* patterns[] = {"nadir", "oblique", "dome", "facade", "rings", "corridor"};
  constexpr const char* vehicles[] = {"generic", "m350_rtk", "generic_ardupilot"};
  const std::string pattern = patterns[draw_index(random, 6)];
  const std::string vehicle = vehicles[draw_index(random, 3)];
  const bool has_lidar = draw_flag(random, 0.15);
  std::string keys = "pattern: {forward_overlap: " + text(draw(random, 0.0, 0.7)) +
                     ", side_overlap: " + text(draw(random, 0.0, 0.7)) + draw_target(random);
  if (draw_flag(random, 0.3)) keys += ", pitch_deg: " + text(draw(random, -90.0, 40.0));
  keys += "}\n";
  std::string sensor = "{width: " + std::to_string(16 + draw_index(random, 30)) +
                       ", height: " + std::to_string(12 + draw_index(random, 20)) +
                       ", horizontal_fov_deg: " + text(draw(random, 30.0, 100.0)) +
                       ", vertical_fov_deg: " + text(draw(random, 20.0, 80.0)) +
                       ", max_range: 60, noise: {sigma: 0.02}" +
                       (draw_flag(random, 0.3) ? ", capture: moving" : "") + "}";
  if (has_lidar) sensor = "{lidar: lidar.yaml}";
  std::string limits = "{max_views: 24";
  if (draw_flag(random, 0.2)) limits += ", stand_off: " + text(draw(random, 0.0, 8.0));
  if (draw_flag(random, 0.2)) limits += ", min_pitch_deg: " + text(draw(random, -90.0, -10.0));
  if (draw_flag(random, 0.2)) limits += ", max_pitch_deg: " + text(draw(random, -20.0, 30.0));
  limits += "}";
  std::string site =
      "latitude_deg: 47.1, longitude_deg: 8.2, ellipsoid_height: 480, geoid_undulation: 48";
  if (draw_flag(random, 0.2)) site += ", max_height: " + text(draw(random, 5.0, 60.0));
  if (draw_flag(random, 0.2)) {
    const double edge = draw(random, 20.0, 60.0);
    site += ", geofence: [" + point(-90, -edge) + ", " + point(edge, -edge) + ", " +
            point(edge, edge) + ", " + point(-90, edge) + "]";
  }
  if (draw_flag(random, 0.2)) {
    const double x = draw(random, -30.0, 30.0);
    site += ", no_fly: [{corners: [" + point(x, -40) + ", " + point(x + 5, -40) + ", " +
            point(x + 5, 10) + ", " + point(x, 10) + "], floor: -10, ceiling: 30}]";
  }
  return "scene: {model: " + model + ", ground: true}\nsensor: " + sensor +
         "\nplanner: {name: " + pattern +
         ", density: 1, resolution_radius: 1.2, spacing: 0.5, view_distance: " +
         text(std::pow(10.0, draw(random, 0.5, 1.5))) +
         ",\n          scene_box: {min: [-24, -24, 0.3], max: [24, 24, 22]}}\n" + keys +
         "flight: {vehicle: " + vehicle +
         ", takeoff: [-75, 0, 0],\n         unknown_box: {min: [-24, -24, 0], max: [24, 24, "
         "22]}}\nsite: {" +
         site +
         "}\nevaluation: {coverage_distance: 0.6, samples: 500, visible_directions: 8,\n"
         "             attainable_views: 0}\nlimits: " +
         limits + "\n";
}

void expect_verified(const Json& summary) {
  const Json& flight = summary.at("flight");
  const double clearance = flight.at("clearance_m").at("total");
  constexpr double rounding = 1e-6;
  EXPECT_GE(flight.at("route").at("min_clearance_m").get<double>(), clearance - rounding);
  EXPECT_GE(flight.at("survey").at("min_clearance_m").get<double>(), clearance - rounding);
  EXPECT_FALSE(flight.at("files").empty());
  for (const Json& file : flight.at("files")) {
    EXPECT_GE(file.at("min_clearance_m").get<double>(), clearance - 0.01) << file.at("name");
  }
  const Json& pattern = summary.at("pattern");
  const std::size_t flown = pattern.at("flown"), planned = pattern.at("planned");
  EXPECT_LE(flown + pattern.at("dropped").size(), planned);
  const std::string reason = summary.at("stop_reason");
  if (reason == "complete" || reason == "nowhere_to_go") {
    EXPECT_EQ(flown + pattern.at("dropped").size(), planned);
  }
}

// PATTERN_SEED and PATTERN_MISSIONS in the environment set the seed and the number of missions.
TEST(PatternMissions, AreVerifiedOrSayWhyNot) {
  const char *seed = std::getenv("PATTERN_SEED"), *count = std::getenv("PATTERN_MISSIONS");
  const std::uint64_t first = seed == nullptr ? 1 : std::stoull(seed);
  const std::uint64_t missions = count == nullptr ? 100 : std::stoull(count);
  std::uint64_t verified = 0;
  for (std::uint64_t i = first; i < first + missions; ++i) {
    RandomNumbers random(i);
    const tests::TestFolder folder;
    const std::string model = folder.write("boxes.obj", draw_boxes(random));
    folder.write("lidar.yaml", small_lidar);
    const std::string mission = draw_mission(random, "boxes.obj");
    const std::string file = folder.write("m.yaml", mission);
    SCOPED_TRACE("PATTERN_SEED=" + std::to_string(i) + "\n" + mission);
    const tests::ProgramRun run =
        tests::run_skycap({"plan", file, "--quiet", "--no-report", "--out", folder / "out"});
    const std::filesystem::path summary = folder.path() / "out" / "summary.json";
    if (run.exit_code == 0) {
      ++verified;
      EXPECT_EQ(run.err, "");
      ASSERT_TRUE(std::filesystem::exists(summary));
      expect_verified(Json::parse(tests::read_content(summary)));
    } else {
      EXPECT_TRUE(run.err.starts_with("skycap: error: ")) << run.err;
      EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
      EXPECT_GT(run.err.size(), 40U);
    }
    if (testing::Test::HasFailure()) break;
  }
  if (missions >= 100) {
    EXPECT_GT(verified, missions / 3);
  }
  RecordProperty("verified", static_cast<int>(verified));
  std::printf("verified: %d of %d\n", static_cast<int>(verified), static_cast<int>(missions));
}

config::MissionSetup teapot_with(const std::string& more) {
  return config::parse_mission(
      tests::flight_mission(), "m.yaml",
      {{"test", "planner.name", more}, {"test", "limits.max_views", "400"}});
}

// The survey flies what the pattern plans, and covers most of what its outline lets it see.
TEST(PatternMissions, CoverTheTeapotTheyAreGranted) {
  for (const auto& [pattern, min_coverage] :
       std::initializer_list<std::pair<const char*, double>>{{"nadir", 0.25},
                                                             {"oblique", 0.6},
                                                             {"dome", 0.6},
                                                             {"facade", 0.6},
                                                             {"rings", 0.4},
                                                             {"corridor", 0.3}}) {
    const config::MissionSetup mission = teapot_with(pattern);
    const evaluation::SurveyScene scene(mission.simulation, "", 0);
    const session::SurveyRecord record = simulation::run_survey(mission.simulation, scene, 1, 1);
    const survey::PatternRecord& flown = record.pattern.value();
    EXPECT_EQ(flown.flown, record.views.size()) << pattern;
    EXPECT_GE(record.coverage(), min_coverage) << pattern;
    EXPECT_GE(record.flight_record.value().min_clearance(), mission.flight().clearance) << pattern;
    EXPECT_EQ(mission.flight().order, flight::VisitOrder::survey);
  }
}

TEST(PatternMissions, MeasureEnRouteWithFewStops) {
  const auto fly = [](const char* capture) {
    const config::MissionSetup mission =
        config::parse_mission(tests::flight_mission(), "m.yaml",
                              {{"test", "planner.name", "nadir"},
                               {"test", "sensor.capture", capture},
                               {"test", "limits.max_views", "400"}});
    const evaluation::SurveyScene scene(mission.simulation, "", 0);
    return simulation::run_survey(mission.simulation, scene, 1, 1);
  };
  const session::SurveyRecord stops = fly("stops"), moving = fly("moving");
  EXPECT_LE(moving.views.size(), stops.views.size());
  EXPECT_GT(moving.en_route_frames(), moving.views.size());
  EXPECT_EQ(stops.en_route_frames(), 0U);
  EXPECT_LE(moving.flight_record.value().time(), stops.flight_record.value().time());
  EXPECT_GE(moving.coverage(), stops.coverage() - 0.02);
}

// Without a scene and prior data, the outline is the only knowledge and serves as ground truth.
TEST(PatternMissions, AreFlownAroundOutlineWithoutScene) {
  for (const std::string outline : {"polygon: [[-6, -4], [6, -4], [6, 4], [0, 9], [-6, 4]]",
                                    "line: [[-12, 0], [0, 3], [12, 0]], width: 3"}) {
    const tests::TestFolder folder;
    const std::string mission =
        "sensor: {width: 80, height: 60, max_range: 100, noise: {sigma: 0.02}}\n"
        "planner: {name: facade, density: 1, resolution_radius: 1.2, spacing: 0.3,\n"
        "          view_distance: 12}\n"
        "pattern: {" +
        outline +
        ", base: 0, top: 9}\n"
        "flight: {vehicle: generic, takeoff: [-75, 0, 0]}\n"
        "site: {latitude_deg: 47.1, longitude_deg: 8.2, ellipsoid_height: 480,\n"
        "       geoid_undulation: 48}\n"
        "evaluation: {coverage_distance: 0.6, samples: 2000, visible_directions: 20,\n"
        "             attainable_views: 0}\n";
    const std::string file = folder.write("m.yaml", mission);
    const tests::ProgramRun refused =
        tests::run_skycap({"plan", file, "--quiet", "--no-report", "--out", folder / "none"});
    EXPECT_NE(refused.exit_code, 0);
    EXPECT_THAT(refused.err, HasSubstr("--use-prior-as-truth"));
    const tests::ProgramRun run = tests::run_skycap(
        {"plan", file, "--use-prior-as-truth", "--quiet", "--no-report", "--out", folder / "out"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Json summary = Json::parse(tests::read_content(folder.path() / "out" / "summary.json"));
    expect_verified(summary);
    EXPECT_EQ(summary.at("pattern").at("dropped").size(), 0U);
    EXPECT_GT(summary.at("coverage_visible").get<double>(), 0.9);
    // The package is complete: it can be exported in another format.
    const tests::ProgramRun exported = tests::run_skycap(
        {"export", folder / "out", "--format", "waypoints", "--out", folder / "ardupilot"});
    EXPECT_EQ(exported.exit_code, 0) << exported.err;
  }
}

TEST(PatternMissions, RejectInconsistentTargetsByKey) {
  const auto message = [](const std::string& pattern) {
    return testing_support::thrown_message([&] {
      config::parse_mission(tests::flight_mission("pattern: {" + pattern + "}\n"), "m.yaml",
                            {{"test", "planner.name", "nadir"}});
    });
  };
  EXPECT_THAT(message("polygon: [[0, 0], [9, 0], [9, 9]]"), HasSubstr("pattern.top"));
  EXPECT_THAT(message("top: 5"), HasSubstr("pattern.top requires pattern.polygon"));
  EXPECT_THAT(message("line: [[0, 0], [9, 0]], polygon: [[0, 0], [9, 0], [9, 9]], top: 5"),
              HasSubstr("conflicts with pattern.polygon"));
  EXPECT_THAT(message("line: [[1, 1], [1, 1]], top: 5"), HasSubstr("two different points"));
  EXPECT_THAT(message("polygon: [[0, 0], [9, 0], [5, 0]], top: 5"), HasSubstr("zero area"));
  EXPECT_THAT(message("polygon: [[0, 0], [9, 0], [9, 9]], top: -5"), HasSubstr("pattern.top"));
  EXPECT_THAT(message("line: [[0, 0]], top: 5"), HasSubstr("two or more points"));
  EXPECT_EQ(message("line: [[0, 0], [9, 0]], top: 5, width: 3"), "");
}

}  // namespace
}  // namespace skycap::missions
