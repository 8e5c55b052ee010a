// End-to-end tests of skycap next and skycap finish.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/points/depth_image.h"
#include "missions/config/resolve.h"
#include "missions/support/number_text.h"
#include "sim/models/models.h"
#include "sim/sensors/depth_camera.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using tests::ProgramRun;
using tests::run_skycap;
using tests::TestFolder;

constexpr const char* live_mission =
    "name: barn\n"
    "sensor: {width: 160, height: 120, horizontal_fov_deg: 60, vertical_fov_deg: 47,\n"
    "         max_range: 8}\n"
    "planner: {name: skycap, density: 5200, resolution_radius: 0.0525,\n"
    "          scene_box: {min: [-1, -1, -0.2], max: [1, 1, 1.5]}}\n"
    "evaluation: {coverage_distance: 0.03}\n";

/// Returns a teapot with a length of 1 m.
geometry::Mesh small_teapot() {
  geometry::Mesh mesh = sim::builtin_model("teapot", {.detail = sim::LevelOfDetail::coarse});
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex /= 6.434;
  return mesh;
}

/// Returns the data in an HTML report.
json page_data(const fs::path& page) {
  const std::string text = tests::read_content(page), begin = "id=\"data\">";
  const std::size_t at = text.find(begin) + begin.size();
  return json::parse(text.substr(at, text.find("</script>", at) - at));
}

// A live mission is not simulated. Missing flight settings are reported.
TEST(CheckLive, SaysWhatFollowsFromTheMission) {
  const TestFolder folder;
  std::ofstream(folder / "barn.yaml") << live_mission;
  const ProgramRun run = run_skycap({"check", folder / "barn.yaml"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              testing::AllOf(HasSubstr("barn.yaml: no problems found\n"),
                             HasSubstr("160 x 120 pixels, 60 x 47 degrees, range 0 to 8 m"),
                             HasSubstr("planner.scene_box, 2 x 2 x 1.7 m"),
                             HasSubstr("first     any view from which the scene is visible"),
                             HasSubstr("Warning: site.geofence is missing")));
  const ProgramRun far =
      run_skycap({"check", folder / "barn.yaml", "--set", "planner.view_distance=9"});
  EXPECT_EQ(far.exit_code, 1) << far.err;
  EXPECT_THAT(far.out,
              HasSubstr("the maximum range of the sensor (8 m) must be greater than the view "
                        "distance (9 m)"));
  EXPECT_THAT(run_skycap({"check", folder / "barn.yaml", "--route", "x.plan"}).err,
              HasSubstr("--route requires a mission with a scene"));
}

TEST(CheckLive, WarnsBeyondTheUsefulRangeOfTheCamera) {
  const TestFolder folder;
  std::string text = live_mission;
  const std::size_t begin = text.find("sensor:"), end = text.find("planner:");
  text.replace(begin, end - begin, "sensor: {preset: intel_d435}\n");
  std::ofstream(folder / "barn.yaml") << text;
  const auto check = [&](const std::string& distance) {
    return run_skycap({"check", folder / "barn.yaml", "--set", "planner.view_distance=" + distance})
        .out;
  };
  EXPECT_THAT(check("4"), HasSubstr("the view distance (4 m) should be in the range in which the "
                                    "camera intel_d435 is accurate (0.3 to 3 m)"));
  EXPECT_THAT(check("2"), testing::Not(HasSubstr("is accurate")));
}

class LiveCommands : public testing::Test {
 protected:
  std::vector<std::string> command(const std::string& name,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{name, folder_ / "barn.yaml", "--survey", folder_ / "survey"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  json answer(const std::vector<std::string>& more, int exit_code = 0) const {
    std::vector<std::string> all = more;
    all.emplace_back("--json");
    const ProgramRun run = run_skycap(command("next", all));
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    return json::parse(run.out);
  }

  /// Writes a depth image of the teapot in millimetres, as a real sensor does. Returns the
  /// arguments for `next`.
  std::vector<std::string> measured(const geometry::View& view, int number) const {
    const sim::DepthCamera camera(config::parse_mission(live_mission, "barn.yaml").sensor().camera);
    const geometry::Scan scan = camera.scan(scene_, view, number, 1);
    const std::string file = folder_ / ("depth_" + std::to_string(number) + ".png");
    geometry::write_depth_png(geometry::depth_image(scan, camera.camera(), 0.001), file);
    const Eigen::Quaterniond q(scan.world_from_sensor.linear());
    std::string pose;
    for (const double n :
         {view.position.x(), view.position.y(), view.position.z(), q.x(), q.y(), q.z(), q.w()}) {
      pose += support::exact_text(n) + " ";
    }
    return {"--scan", file, "--pose", pose};
  }

  TestFolder folder_;
  std::string mission_ = folder_.write("barn.yaml", live_mission);
  sim::Scene scene_ = sim::Scene(small_teapot(), 1);
};

TEST_F(LiveCommands, SurveyWithoutSceneModel) {
  EXPECT_EQ(answer({})["state"], "first_scan");
  const fs::path page = folder_.path() / "survey" / "report.html";
  EXPECT_FALSE(fs::exists(page));  // there are no data yet
  geometry::View view = geometry::look_at({2.5, 1.0, 1.2}, {0.0, 0.0, 0.3});
  for (int i = 0; i < 4; ++i) {
    const json next = answer(measured(view, i));
    EXPECT_EQ(next["state"], "view");
    EXPECT_EQ(next["id"], i + 1);
    const json& at = next["view"]["position"];
    const json& to = next["view"]["direction"];
    for (int axis = 0; axis < 3; ++axis) {
      view.position[axis] = at[axis].get<double>();
      view.direction[axis] = to[axis].get<double>();
    }
    EXPECT_NEAR(view.direction.norm(), 1.0, 1e-9);
    const json data = page_data(page);
    EXPECT_EQ(data["summary"]["views"], i + 1);
    EXPECT_EQ(data["live"]["position"], at);
    EXPECT_EQ(data["clouds"]["measured"]["of"], next["points"]);
  }
  const ProgramRun finished = run_skycap(command("finish"));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  const json summary = json::parse(tests::read_content(folder_.path() / "survey" / "summary.json"));
  EXPECT_EQ(summary["views"], 4);
  EXPECT_TRUE(summary["coverage"].is_null());
  EXPECT_EQ(summary["stop_reason"], "interrupted");
  EXPECT_TRUE(fs::exists(folder_.path() / "survey" / "cloud.ply"));
  const json data = page_data(page);  // the final report, which does not refresh itself
  EXPECT_FALSE(data.contains("live"));
  EXPECT_EQ(data["summary"], summary);
}

TEST_F(LiveCommands, AcceptSameScanTwice) {
  const std::vector<std::string> call =
      measured(geometry::look_at({2.5, 1.0, 1.2}, {0.0, 0.0, 0.3}), 0);
  EXPECT_EQ(answer(call), answer(call));
  EXPECT_THAT(run_skycap(command("next", call)).err, HasSubstr("already known"));
}

TEST_F(LiveCommands, WarnAboutWrongPose) {
  const geometry::View view = geometry::look_at({1.6, 0.7, 0.8}, {0.0, 0.0, 0.3});
  answer(measured(view, 0));
  std::vector<std::string> call = measured(view, 1);
  call.back() = measured(geometry::look_at({1.6, 0.8, 0.8}, {0.0, 0.1, 0.3}), 2).back();
  const json wrong = answer(call, 12);
  EXPECT_EQ(wrong["warning"], "pose");
  EXPECT_EQ(wrong["scans"], 1);
  EXPECT_GT(wrong["pose"]["shift_m"].get<double>(), 0.03);
  const ProgramRun run = run_skycap(command("next"));
  EXPECT_EQ(run.exit_code, 12);
  EXPECT_THAT(run.out, HasSubstr("warning: scan rejected: pose inconsistent with the map"));
  call.insert(call.end(), {"--pose-sigma", "0.1"});
  EXPECT_THAT(run_skycap(command("next", call)).err, HasSubstr("metres degrees"));
  call.back() = "0.1 1";
  call.insert(call.end(), {"--pose-covariance", "0.01"});
  EXPECT_THAT(run_skycap(command("next", call)).err, HasSubstr("conflicts with"));
  call.erase(call.end() - 4, call.end() - 2);
  EXPECT_THAT(run_skycap(command("next", call)).err, HasSubstr("--pose-covariance: has 1 numbers"));
  call.back() = "0.01 0 0 0 0 0  0.01 0 0 0 0  0.01 0 0 0  1e-4 0 0  1e-4 0  1e-4";
  EXPECT_FALSE(answer(call).contains("warning"));
}

TEST_F(LiveCommands, ReportMissingInput) {
  const auto rejection = [&](const std::vector<std::string>& arguments) {
    const ProgramRun run = run_skycap(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    return run.err;
  };
  EXPECT_THAT(rejection({"plan", mission_}), HasSubstr("scene.model is missing"));
  EXPECT_THAT(rejection({"scan", mission_}), HasSubstr("scene.model is missing"));
  EXPECT_THAT(rejection(command("finish")), HasSubstr("contains no scans yet"));
  EXPECT_THAT(rejection(command("next", {"--scan", "x.ply"})), HasSubstr("--pose"));
  EXPECT_THAT(rejection(command("next", {"--refuse", "no"})), HasSubstr("no view to reject"));
  EXPECT_THAT(rejection(command("next", {"--en-route"})), HasSubstr("--en-route requires --scan"));
  std::vector<std::string> en_route =
      measured(geometry::look_at({2.5, 1.0, 1.2}, {0.0, 0.0, 0.3}), 0);
  en_route.emplace_back("--en-route");
  EXPECT_THAT(rejection(command("next", en_route)),
              HasSubstr("en-route scans require sensor.capture: moving"));
  const std::string bare = folder_.write("bare.yaml", "evaluation: {coverage_distance: 1}\n");
  EXPECT_THAT(rejection({"next", bare, "--survey", folder_ / "s"}), HasSubstr("planner.scene_box"));
}

}  // namespace
}  // namespace skycap::missions
