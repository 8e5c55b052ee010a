// Surveys by scanners that do not see a ring at a time: from the opening flight to the end.
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "missions/derived/resolved_mission.h"
#include "missions/run/survey_runner.h"
#include "missions/scene/survey_scene.h"

namespace skycap::missions {
namespace {

/// A teapot of 20 m in a box, on the ground.
file::Mission mission_by(const std::string& lidar) {
  return derived::parse_mission(
      "scene: {model: 'builtin:teapot', longest_side: 20.0, ground: true}\n"
      "sensor: {lidar: " +
          lidar +
          "}\n"
          "planner: {density: 4, resolution_radius: 1, spacing: 0.2, view_distance: 14,\n"
          "          scene_box: {min: [-11, -9, 0.3], max: [11, 9, 11]}}\n"
          "flight: {vehicle: m350_rtk, takeoff: [-60, 0, 0], cruise_speed: 5,\n"
          "         unknown_box: {min: [-11, -9, 0], max: [11, 9, 11]}}\n"
          "evaluation: {registration_distance: 0.4, samples: 3000, visible_directions: 30,\n"
          "             ceiling_views: 0}\n"
          "limits: {max_views: 40}\n",
      "m.yaml");
}

/// What the planner believes of its coverage, against the share that is covered of what could be
/// seen.
void expect_survey(const std::string& lidar, double least_coverage) {
  const file::Mission mission = mission_by(lidar);
  const scene::SurveyScene scene(mission, "");
  const run::SurveyRecord record = run::run_survey(mission, scene, 1, 1);
  EXPECT_TRUE(record.is_complete()) << survey::name_of(record.stop_reason);
  EXPECT_LT(record.views.size(), 40U);
  EXPECT_GE(record.flown.value().min_clearance(), mission.flight.clearance);
  const std::vector<std::uint8_t> is_visible = scene.visible(1);
  std::size_t visible = 0, covered = 0;
  for (std::size_t i = 0; i < record.is_covered.size(); ++i) {
    if (is_visible.at(i) == 0) continue;
    ++visible;
    covered += record.is_covered[i];
  }
  const double share = static_cast<double>(covered) / static_cast<double>(visible);
  EXPECT_GT(share, least_coverage);
  EXPECT_NEAR(record.belief.value().coverage, share, 0.06);
}

TEST(ScannerSurvey, ByARosetteEndsByItselfAndKnowsWhatItCovered) {
  expect_survey("livox_mid70", 0.85);
}

TEST(ScannerSurvey, ByALineEndsByItselfAndKnowsWhatItCovered) {
  expect_survey("riegl_minivux_1uav", 0.85);
}

}  // namespace
}  // namespace skycap::missions
