// Surveys with scanners that do not measure full rings, from the initial pattern to the end.
#include <string>

#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/initial_pattern_flight.h"
#include "missions/simulation/expectation.h"
#include "missions/simulation/survey_runner.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

/// Returns a mission with a teapot of 20 m on the ground and a box around it.
config::MissionSetup mission_by(const std::string& lidar) {
  return config::parse_mission(
      "scene: {model: 'builtin:teapot', longest_side: 20.0, ground: true}\n"
      "sensor: {lidar: " +
          lidar +
          "}\n"
          "planner: {density: 4, resolution_radius: 1, spacing: 0.2, view_distance: 14,\n"
          "          scene_box: {min: [-11, -9, 0.3], max: [11, 9, 11]}}\n"
          "flight: {vehicle: m350_rtk, takeoff: [-80, 0, 0], cruise_speed: 5,\n"
          "         unknown_box: {min: [-11, -9, 0], max: [11, 9, 11]}}\n"
          "evaluation: {coverage_distance: 0.4, samples: 3000, visible_directions: 30,\n"
          "             attainable_views: 0}\n"
          "limits: {max_views: 40}\n",
      "m.yaml");
}

/// Compares the planner's estimated coverage with the covered fraction of the visible surface.
void expect_survey(const std::string& lidar, double min_coverage) {
  const config::MissionSetup mission = mission_by(lidar);
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const session::SurveyRecord record = simulation::run_survey(mission.simulation, scene, 1, 1);
  EXPECT_TRUE(record.is_complete()) << survey::to_string(record.stop_reason);
  EXPECT_LT(record.views.size(), 40U);
  EXPECT_GE(record.flight_record.value().min_clearance(), mission.flight().clearance);
  const double share = evaluation::covered_share(record.is_covered, scene.visible(1)).value();
  EXPECT_GT(share, min_coverage);
  EXPECT_NEAR(record.estimate.value().coverage, share, 0.06);
}

TEST(ScannerSurvey, EndsAndEstimatesCoverageWithRosette) { expect_survey("livox_mid70", 0.85); }

TEST(ScannerSurvey, EndsAndEstimatesCoverageWithSingleLineLidar) {
  expect_survey("riegl_minivux_1uav", 0.85);
}

// For a scanner with a fixed downward pitch, a random view of the scene's centre may not exist.
TEST(ScannerSurvey, IsPredictedFromStartOfInitialPattern) {
  for (const char* lidar : {"livox_avia", "riegl_minivux_1uav", "ouster_os1_128"}) {
    const config::MissionSetup mission = mission_by(lidar);
    const evaluation::SurveyScene scene(mission.simulation, "", 0);
    EXPECT_EQ(
        scene.first_view(mission.run.seed).position,
        session::initial_pattern_views(mission.survey().start, mission.run.seed).front().position);
    EXPECT_GT(simulation::expectation(mission.simulation, scene, {.threads = 2}).known_views, 0U)
        << lidar;
  }
}

TEST(ScannerSurvey, RunsWithEveryPlanner) {
  const tests::TestFolder folder;
  const std::string lidar = folder.write(
      "lidar.yaml",
      "name: test\nkind: spinning\ncolumns_per_turn: 720\nrotation_rate_hz: 10\n"
      "channels: {count: 64, lowest_deg: -20, highest_deg: 20}\nrange: {min: 0.1, max: 20}\n"
      "errors: {sigma: 0.01}\n");
  for (const char* name : {"see++", "see", "skycap", "rsv"}) {
    const config::MissionSetup mission = config::parse_mission(
        "scene: {model: builtin:teapot, longest_side: 1}\nsensor: {lidar: " + lidar +
            "}\nplanner: {name: " + name +
            ", density: 20000, resolution_radius: 0.08, spacing: 0.02, view_distance: 1.5}\n"
            "limits: {max_views: 30}\n"
            "evaluation: {coverage_distance: 0.03, samples: 2000, attainable_views: 0}\n",
        "m.yaml");
    const session::SurveyRecord record = simulation::run_survey(
        mission.simulation, evaluation::SurveyScene(mission.simulation, "", 0), 1, 1);
    EXPECT_GT(record.views.size(), 2U) << name;
    // Twice the fraction that one view shows of the teapot.
    EXPECT_GT(record.coverage(), 0.4) << name;
  }
}

}  // namespace
}  // namespace skycap::missions
