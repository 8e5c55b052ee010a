// Missions through the C++ library give the same results as the program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "missions/api/evaluation.h"
#include "missions/api/laser_scan.h"
#include "missions/api/mission.h"
#include "missions/api/sensors.h"
#include "missions/api/simulation.h"
#include "missions/api/survey.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"

namespace skycap::missions::api {
namespace {

using testing::HasSubstr;

constexpr const char* cube =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

constexpr const char* cube_mission =
    "scene: {model: cube.obj}\n"
    "sensor: {width: 160, height: 120}\n"
    "planner: {name: skycap, density: 1000, resolution_radius: 0.2}\n"
    "limits: {max_views: 3}\n"
    "scan:\n"
    "  sensor: velodyne_vlp16\n"
    "  orbit: {radius: 5, min_height: 1, circles: 1, speed: 100}\n"
    "evaluation: {coverage_distance: 0.1, samples: 1000, attainable_views: 0}\n";

class Library : public testing::Test {
 protected:
  Library() {
    folder.write("cube.obj", cube);
    file = folder.write("cube.yaml", cube_mission);
  }

  tests::TestFolder folder;
  std::string file;
};

TEST_F(Library, MatchesPlanCommandByteForByte) {
  for (const std::string planner : {"skycap", "see++"}) {
    const std::string by_program = folder / ("program-" + planner),
                      by_library = folder / ("library-" + planner);
    ASSERT_EQ(
        tests::run_skycap({"plan", file, "--planner", planner, "--quiet", "--out", by_program}).err,
        "");
    std::size_t reported = 0;
    const Survey survey =
        plan(Mission::load(file, {{"planner.name", planner}}),
             {.folder = by_library, .report = [&](const auto&, double) { ++reported; }});
    for (const char* name : {"cloud.ply", "coverage.ply", "views.csv", "trajectory.tum"}) {
      EXPECT_EQ(tests::read_content(by_library + "/" + name),
                tests::read_content(by_program + "/" + name))
          << planner << ": " << name;
    }
    EXPECT_EQ(survey.summary, tests::read_content(by_library + "/summary.json"));
    EXPECT_EQ(reported, survey.views.size());
    EXPECT_GT(survey.coverage(), 0.0);
  }
}

/// The planner alone, with scans from a simulator of the test, selects the same views as a complete
/// survey.
TEST_F(Library, PlansSameViewsFromExternalScans) {
  const Mission mission = Mission::load(file);
  const Survey survey = plan(mission);
  sim::DepthCameraConfig config = sim::d435();
  config.camera = mission.camera();
  config.noise.seed = mission.seed();
  const sim::DepthCamera camera(config);
  const sim::Scene scene(mission.model());
  std::uint64_t frame = 0;
  const survey::SurveyCallbacks callbacks{.sense = [&](const geometry::View& view, geometry::Scan) {
    return camera.scan(scene, view, frame++);
  }};
  const std::unique_ptr<survey::Planner> planner = mission.planner();
  const survey::SurveyResult own =
      survey::run_survey(*planner, survey.views.front().view, {.max_views = 3}, callbacks);
  ASSERT_EQ(own.views.size(), survey.views.size());
  for (std::size_t i = 0; i < own.views.size(); ++i) {
    EXPECT_EQ(own.views[i].view.position, survey.views[i].view.position) << "view " << i;
    EXPECT_EQ(own.views[i].points, survey.views[i].points) << "view " << i;
  }
}

TEST_F(Library, SimulatesSameScansAsSurvey) {
  const Mission mission = Mission::load(file);
  const Survey survey = plan(mission);
  const Simulation simulation(mission);
  const std::unique_ptr<survey::Planner> planner = mission.planner();
  std::optional<geometry::View> view = simulation.first_view();
  ASSERT_FALSE(survey.views.empty());
  for (std::size_t i = 0; i < survey.views.size(); ++i) {
    ASSERT_TRUE(view) << "view " << i;
    EXPECT_EQ(view->position, survey.views[i].view.position) << "view " << i;
    const geometry::Scan scan = simulation.scan(*view, i);
    EXPECT_EQ(scan.points.size(), survey.views[i].returns) << "view " << i;
    view = planner->next_view(scan);
  }
  EXPECT_TRUE(planner->cloud().positions == survey.cloud.positions);
}

/// Half of a sheet, at a known height.
TEST_F(Library, EvaluatesCloudDistanceAndCoverage) {
  const geometry::Mesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i <= 50; ++i) {
    for (int j = 0; j <= 100; ++j) {
      points.push_back({0.01F * static_cast<float>(i), 0.01F * static_cast<float>(j), 0.003F});
    }
  }
  const Evaluation evaluation = evaluate(points, sheet, {.distance = 0.01});
  EXPECT_NEAR(evaluation.mean, 0.003, 1e-8);
  EXPECT_NEAR(evaluation.largest, 0.003, 1e-8);
  // The distance reaches sqrt(0.01^2 - 0.003^2) beyond the measured half.
  EXPECT_NEAR(evaluation.coverage, 0.5 + 0.0095, 0.002);
  EXPECT_NEAR(evaluation.density, static_cast<double>(points.size()), 1e-6);
  EXPECT_THAT(testing_support::thrown_message([&] { evaluate({}, sheet); }),
              testing::HasSubstr("the cloud has no points"));
  EXPECT_THAT(testing_support::thrown_message([&] { evaluate(points, sheet, {.distance = 0.0}); }),
              testing::HasSubstr("distance is 0.0"));
}

TEST_F(Library, FindsSensorsByName) {
  for (const std::string& name : testing_support::not_empty(sensor_names())) {
    const bool is_camera = name.starts_with("intel_") || name.starts_with("see_") ||
                           name.ends_with("_wide") || name == "dji_zenmuse_p1";
    if (is_camera) {
      EXPECT_NO_THROW(depth_camera(name)) << name;
      EXPECT_THAT(testing_support::thrown_message([&] { laser_scanner(name); }),
                  testing::HasSubstr(" is a camera"))
          << name;
    } else {
      EXPECT_NO_THROW(laser_scanner(name)) << name;
      EXPECT_THAT(testing_support::thrown_message([&] { depth_camera(name); }),
                  testing::HasSubstr(" is a laser scanner"))
          << name;
    }
  }
}

TEST_F(Library, ScansSamePointsInPiecesAsProgram) {
  ASSERT_EQ(tests::run_skycap({"scan", file, "--quiet", "--out", folder / "scan"}).err, "");
  LaserScan scan(Mission::load(file), {});
  std::size_t points = 0;
  for (auto parts = scan.next(); !parts.empty(); parts = scan.next()) {
    for (const sim::LidarReturns& part : parts) points += part.size();
  }
  EXPECT_EQ(points, geometry::read_cloud(folder / "scan/scan.las").positions.size());
  EXPECT_GT(points, 0U);
}

TEST_F(Library, OverridesKeysAndNamesInvalidSettings) {
  EXPECT_EQ(Mission::load(file, {{"seed", "7"}}).seed(), 7U);
  try {
    Mission::load(file, {{"limits.max_views", "many"}});
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("limits.max_views"));
  }
}

TEST_F(Library, RejectsCameraForLaserScan) {
  try {
    LaserScan scan(Mission::load(file), {.sensor = "intel_d435"});
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("is a camera"));
  }
}

}  // namespace
}  // namespace skycap::missions::api
