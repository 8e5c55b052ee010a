#include "missions/cli/live_scene.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/io/record_log.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "sim/sensors/survey_sensor.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions::cli {
namespace {

using testing::HasSubstr;
using testing_support::thrown_message;

config::MissionSetup make_setup(const std::string& text) {
  return config::parse_mission(text, "m.yaml");
}

nlohmann::ordered_json identity_in(const tests::TestFolder& folder) {
  return nlohmann::ordered_json::parse(
      geometry::read_records(folder.path() / "live.journal").records.at(0));
}

TEST(OpenSurvey, StartsAtSameViewAsPlanInScene) {
  const tests::TestFolder folder;
  const config::MissionSetup setup = make_setup(tests::quick_mission("seed: 7\n"));
  const evaluation::SurveyScene scene(setup.simulation, "", setup.run.threads);
  const auto survey = open_survey(setup, "", folder.path());
  const geometry::View first = scene.first_view(7);
  ASSERT_TRUE(survey->proposal().view);
  EXPECT_EQ(survey->proposal().view->position, first.position);
  EXPECT_EQ(survey->proposal().view->direction, first.direction);
  EXPECT_EQ(identity_in(folder)["seed"], 7);
}

/// Prevents resuming a survey in a different scene.
TEST(OpenSurvey, KeepsSceneSphereInJournal) {
  const tests::TestFolder folder, other;
  const config::MissionSetup setup = make_setup(tests::quick_mission());
  const survey::ViewSphere sphere =
      evaluation::SurveyScene(setup.simulation, "", setup.run.threads).view_sphere();
  open_survey(setup, "", folder.path());
  const auto identity = identity_in(folder);
  EXPECT_NEAR(std::stod(identity["volumetric.sphere_radius"].get<std::string>()), sphere.radius,
              1e-10);
  const auto centre = identity["volumetric.sphere_centre"].get<std::string>();
  EXPECT_NEAR(std::stod(centre.substr(1)), sphere.centre.x(), 1e-10);

  open_survey(make_setup(tests::quick_mission("volumetric: {sphere_radius: 3}\n")), "",
              other.path());
  EXPECT_EQ(identity_in(other)["volumetric.sphere_radius"], "3");
}

TEST(OpenSurvey, StartsAtConfiguredViewWithoutScene) {
  const std::string rest =
      "planner: {density: 5200, resolution_radius: 0.0525,\n"
      "          scene_box: {min: [-1, -1, -1], max: [1, 1, 1]}}\n"
      "evaluation: {coverage_distance: 0.03}\n";
  const tests::TestFolder given, left_open;
  const auto survey = open_survey(
      make_setup(rest + "start: {position: [3, 0, 0], look_at: [0, 0, 0]}\n"), "", given.path());
  ASSERT_TRUE(survey->proposal().view);
  EXPECT_EQ(survey->proposal().view->position, Eigen::Vector3d(3, 0, 0));
  EXPECT_EQ(survey->proposal().view->direction, Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(identity_in(given)["volumetric.sphere_radius"], "-");
  EXPECT_FALSE(open_survey(make_setup(rest), "", left_open.path())->proposal().view);
}

/// The pose differs from the requested view. The noise depends on the scan number.
TEST(SimulatedSensor, MeasuresFromActualVehiclePose) {
  const config::MissionSetup setup = make_setup(tests::quick_mission());
  const geometry::View requested{{3, 0, 0}, {-1, 0, 0}}, actual_view{{0, 2, 0.5}, {0, -1, 0}};
  const geometry::Scan scan =
      simulated_sensor(setup.simulation, "", setup.run)(requested, actual_view, 5);
  const evaluation::SurveyScene scene(setup.simulation, "", setup.run.threads);
  const geometry::Scan expected =
      sim::SurveySensor(setup.sensor(), setup.run.seed).scan(scene.scene(), actual_view, 5, 1);
  EXPECT_FALSE(scan.points.empty());
  EXPECT_TRUE(scan.points == expected.points);
  EXPECT_TRUE(scan.world_from_sensor.isApprox(geometry::camera_pose(actual_view)));
}

TEST(SimulatedSensor, RequiresScene) {
  evaluation::SimulationOptions options = make_setup(tests::quick_mission()).simulation;
  options.scene.model.clear();
  EXPECT_THAT(thrown_message([&] { simulated_sensor(options, "", {}); }), HasSubstr("scene.model"));
}

}  // namespace
}  // namespace skycap::missions::cli
