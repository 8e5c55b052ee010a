#include "missions/simulation/mounted_sensor.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "missions/simulation/survey_runner.h"
#include "sim/sensors/survey_sensor.h"
#include "tests/missions/simulated_mission.h"
#include "tests/sim/shapes.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using geometry::Scan;

using Keys = std::vector<std::pair<std::string, std::string>>;

config::MissionSetup mission_with(const Keys& keys) {
  std::vector<config::KeyOverride> overrides;
  for (const auto& [key, value] : keys) overrides.push_back({"--set", key, value});
  return config::parse_mission(tests::flight_mission(), "m.yaml", overrides);
}

/// Returns a mission without noise.
config::MissionSetup exact_mission(Keys keys = {}) {
  keys.emplace_back("sensor.noise.sigma", "0");
  return mission_with(keys);
}

const sim::Scene wall(sim::square({12, 0, 0}, -Vector3d::UnitX(), 400.0), 1);
const geometry::View at_wall{Vector3d::Zero(), Vector3d::UnitX()};

/// Returns the points of a sensor that does not move.
std::vector<Eigen::Vector3f> points_at_rest(const config::MissionSetup& mission,
                                            const geometry::View& view, std::uint64_t seed,
                                            std::uint64_t frame) {
  return sim::SurveySensor(mission.simulation.sensor, seed).scan(wall, view, frame, 1).points;
}

// A pixel in a corner moves by 252 px per radian, and motion is evaluated at 16 m. At 1.35 m/s the
// image moves by half a pixel during a readout of 0.02 s, in addition to the hover drift.
TEST(MountedSensor, IsAtRestBelowHalfAPixelOfMotion) {
  const config::MissionSetup mission =
      mission_with({{"sensor.exposure", "0.001"}, {"sensor.readout", "0.02"}});
  const std::vector<Eigen::Vector3f> standing = points_at_rest(mission, at_wall, 3, 5);
  ASSERT_GT(standing.size(), 1000U);
  const auto scan_at_speed = [&](double speed) {
    simulation::MountedSensor mounted(mission.simulation, 3);
    return mounted.scan(wall, {.view = at_wall, .velocity = {speed, 0.0, 0.0}}, 5, 1).points;
  };
  EXPECT_EQ(scan_at_speed(0.0), standing);
  EXPECT_EQ(scan_at_speed(1.0), standing);
  EXPECT_NE(scan_at_speed(2.0), standing);
}

// 160 pixels for 69.4 degrees: f = 116 px. At 16 m, 8 m/s for 0.2 s exceed 11.5 pixels.
TEST(MountedSensor, ComputesRollingShutterSkew) {
  const config::MissionSetup mission =
      exact_mission({{"sensor.exposure", "0.001"}, {"sensor.readout", "0.2"}});
  simulation::MountedSensor mounted(mission.simulation, 3);
  const Scan scan = mounted.scan(wall, {.view = at_wall, .velocity = {8.0, 0.0, 0.0}}, 0, 1);
  ASSERT_GT(scan.points.size(), 1000U);
  // The top rows are read first. They are farther away, by at most 0.8 m before the middle of the
  // frame.
  const auto& [top, bottom] = std::pair(scan.points.front(), scan.points.back());
  const double sway = 0.1 * 0.1 + 0.1 * 0.0087 * 12.0 * 1.2;  // during half of the readout
  EXPECT_NEAR(top.x(), 12.8, 0.02 + sway);
  EXPECT_NEAR(bottom.x(), 11.2, 0.02 + sway);
}

TEST(MountedSensor, VariesHoverDriftByFrameAndSeed) {
  const config::MissionSetup mission = exact_mission({{"sensor.readout", "3"}});
  const auto first_point = [&](std::uint64_t seed, std::uint64_t frame) {
    simulation::MountedSensor mounted(mission.simulation, seed);
    return mounted.scan(wall, {.view = at_wall}, frame, 1).points.front();
  };
  EXPECT_EQ(first_point(1, 0), first_point(1, 0));
  EXPECT_NE(first_point(1, 0), first_point(1, 1));
  EXPECT_NE(first_point(1, 0), first_point(2, 0));
}

TEST(MountedSensor, HasCorrelatedNavigationErrors) {
  const config::MissionSetup mission = exact_mission(
      {{"scan.navigation.horizontal_sigma", "0.3"}, {"scan.navigation.correlation_time", "50"}});
  double square = 0.0, change = 0.0, before = 0.0;
  constexpr int pairs = 200, frames = 2 * pairs;
  simulation::MountedSensor mounted(mission.simulation, 1);
  for (int i = 0; i < frames; ++i) {
    // Each second scan immediately follows the previous one.
    const int pair = i / 2;
    const double time = 500.0 * pair + (i % 2 == 0 ? 0.0 : 0.5);
    const Scan scan = mounted.scan(wall, {.view = at_wall, .time = time}, i, 1);
    const double error = scan.points.front().x() - 12.0;
    for (std::size_t k = 0; k < scan.points.size(); k += 997) {
      ASSERT_NEAR(scan.points[k].x() - 12.0, error, 1e-5);
    }
    square += error * error / frames;
    if (i % 2 == 1) change += (error - before) * (error - before) / pairs;
    before = error;
  }
  // With 200 independent samples, four standard deviations of their variance are 40%.
  EXPECT_NEAR(square, 0.09, 0.4 * 0.09);
  EXPECT_NEAR(change, 2.0 * 0.09 * (1.0 - std::exp(-0.5 / 50.0)), 0.5 * 0.0018);
}

TEST(MountedSensor, IgnoresNavigationErrorsWithoutVehicle) {
  const std::string text =
      "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.05}\n"
      "planner: {name: skycap, density: 100, resolution_radius: 0.2}\n"
      "scan: {navigation: {horizontal_sigma: 0.5}}\n";
  const config::MissionSetup mission = config::parse_mission(text, "m.yaml");
  simulation::MountedSensor mounted(mission.simulation, 1);
  const geometry::View near{{10, 0, 0}, Vector3d::UnitX()};
  EXPECT_EQ(mounted.scan(wall, {.view = near}, 0, 1).points, points_at_rest(mission, near, 1, 0));
}

// With pose errors of the permitted point error, the survey covers less, and its estimate is lower.
TEST(MountedSensor, LowersEstimatedCoverageWithPoseErrors) {
  const Keys few{{"limits.max_views", "5"}, {"planner.target_coverage", "1"}};
  const config::MissionSetup exact = mission_with(few);
  Keys keys = few;
  keys.insert(keys.end(), {{"scan.navigation.horizontal_sigma", "0.5"},
                           {"scan.navigation.vertical_sigma", "0.5"},
                           {"scan.navigation.correlation_time", "1"}});
  const config::MissionSetup astray = mission_with(keys);
  const evaluation::SurveyScene scene(exact.simulation, "", 0);
  const session::SurveyRecord well = simulation::run_survey(exact.simulation, scene, 1, 2),
                              badly = simulation::run_survey(astray.simulation, scene, 1, 2);
  EXPECT_LT(badly.coverage(), well.coverage() - 0.05);
  EXPECT_LT(badly.estimate->coverage, well.estimate->coverage - 0.05);
}

}  // namespace
}  // namespace skycap::missions
