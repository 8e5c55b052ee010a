#include "missions/package/package.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/text/ply.h"
#include "geometry/pose/pose.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/coverage.h"
#include "missions/package/cloud_normals.h"
#include "missions/support/sha256.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Json = nlohmann::json;
using testing::HasSubstr;

/// Returns a survey of two views with numbers that have no short decimal form.
session::SurveyRecord two_views() {
  session::SurveyRecord record;
  record.seed = 9;
  record.stop_reason = survey::StopReason::view_limit;
  session::EvaluatedView first, second;
  first.surveyed.view = geometry::look_at({1.0 / 3.0, -2, 0.1}, {0, 0, 0});
  first.surveyed.step = {.points_new = 2, .frontiers = 5, .times = {{"insert", 0.25}}};
  first.surveyed.points = 2;
  first.surveyed.returns = 4;
  first.surveyed.planning_time = 0.25;
  first.coverage = 1.0 / 7.0;
  second = first;
  second.surveyed.view = geometry::look_at({0, 0, 2}, {0, 0, 0});  // straight down
  second.surveyed.distance = std::sqrt(2.0);
  second.surveyed.points = 3;
  second.surveyed.step.times = {{"insert", 0.5}, {"select", 0.125}};
  second.surveyed.planning_time = 0.625;
  second.coverage = 2.0 / 7.0;
  record.views = {first, second};
  record.cloud.positions = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}};
  record.cloud.views = {0, 0, 1};
  return record;
}

/// Returns a minimal mission.
config::MissionSetup make_mission(const std::string& model = "builtin:teapot") {
  return config::parse_mission(
      "scene: {model: '" + model + "'}\nevaluation: {coverage_distance: 0.01}\n", "m.yaml");
}

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<double> numbers_in(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream stream(line);
  std::vector<double> numbers;
  for (std::string word; stream >> word;) numbers.push_back(std::stod(word));
  return numbers;
}

TEST(Package, WritesViewsThatReadBackExactly) {
  const session::SurveyRecord record = two_views();
  const auto lines = split_lines(package::views_csv(record));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0],
            "view,x,y,z,direction_x,direction_y,direction_z,returns,points_new,points,frontiers,"
            "coverage,distance_m");
  const auto first = numbers_in(lines[1]);
  ASSERT_EQ(first.size(), 13U);
  EXPECT_EQ(first[1], 1.0 / 3.0);
  EXPECT_EQ(Vector3d(first[4], first[5], first[6]), record.views[0].surveyed.view.direction);
  EXPECT_EQ(first[11], 1.0 / 7.0);
  EXPECT_EQ(numbers_in(lines[2])[12], std::sqrt(2.0));
}

TEST(Package, WritesCameraPosesAsTrajectory) {
  const session::SurveyRecord record = two_views();
  const auto lines = split_lines(package::trajectory_tum(record));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], "# timestamp tx ty tz qx qy qz qw");
  for (std::size_t i = 0; i < 2; ++i) {
    const auto numbers = numbers_in(lines[i + 1]);
    ASSERT_EQ(numbers.size(), 8U);
    EXPECT_EQ(numbers[0], static_cast<double>(i));
    const Eigen::Quaterniond turn(numbers[7], numbers[4], numbers[5], numbers[6]);
    const geometry::View& view = record.views[i].surveyed.view;
    EXPECT_EQ(Vector3d(numbers[1], numbers[2], numbers[3]), view.position);
    EXPECT_LT((turn * Vector3d::UnitZ() - view.direction).norm(), 1e-12);
  }
}

TEST(Package, WritesAllSummaryFields) {
  const package::CoverageFigures coverage{2.0 / 7.0, 0.5, {}};
  const auto summary =
      nlohmann::json::parse(package::summary_json(make_mission(), two_views(), coverage));
  for (const char* field :
       {"mission", "planner", "preset", "seed", "threads", "version", "views", "points", "coverage",
        "coverage_visible", "attainable_coverage", "planning_time_s", "sensing_time_s",
        "distance_m", "complete", "stop_reason", "per_view"}) {
    EXPECT_TRUE(summary.contains(field)) << field;
  }
  EXPECT_EQ(summary["planner"], "see++");
  EXPECT_EQ(summary["stop_reason"], "view_limit");
  EXPECT_EQ(summary["complete"], false);
  EXPECT_EQ(summary["planning_time_s"], 0.875);
  EXPECT_EQ(summary["planning_time_parts_s"]["insert"], 0.75);
  EXPECT_EQ(summary["planning_time_parts_s"]["select"], 0.125);
  EXPECT_TRUE(summary["attainable_coverage"].is_null());
  EXPECT_FALSE(summary.contains("route_length_m"));  // there is no flight
  ASSERT_EQ(summary["per_view"].size(), 2U);
  for (const char* field : {"view", "position", "direction", "points_new", "points", "frontiers",
                            "coverage", "planning_time_s", "distance_m"}) {
    EXPECT_TRUE(summary["per_view"][1].contains(field)) << field;
  }
}

TEST(Package, WritesOnlyApplicableSettings) {
  const auto settings = [](const std::string& model) {
    return nlohmann::json::parse(
        package::summary_json(make_mission(model), two_views(), {}))["settings"];
  };
  EXPECT_EQ(settings("builtin:teapot")["scene.detail"], "standard");
  EXPECT_FALSE(settings("house.ply").contains("scene.detail"));
}

TEST(Package, ReplacesInvalidUtf8InSummary) {
  config::MissionSetup mission = make_mission();
  mission.name = "vase\xff";
  EXPECT_THAT(package::summary_json(mission, two_views(), {}), HasSubstr("vase\xef\xbf\xbd"));
}

TEST(Package, WritesCloudWithNormalsTowardsSensors) {
  const tests::TestFolder folder;
  {
    geometry::OutputFolder out(folder.path());
    package::stage_package(make_mission(), two_views(), {}, 1, out);
    // Files appear only after commit().
    EXPECT_FALSE(std::filesystem::exists(folder / "cloud.ply"));
    out.commit();
  }
  const auto cloud = geometry::read_cloud(folder / "cloud.ply");
  EXPECT_EQ(cloud.positions, two_views().cloud.positions);
  EXPECT_EQ(cloud.views, two_views().cloud.views);
  ASSERT_EQ(cloud.normals.size(), 3U);
  EXPECT_GT(cloud.normals[2].z(), 0.99F);  // seen from directly above
}

// The planner's estimate is written as consistent numbers and as a map with corresponding colours.
TEST(Package, WritesPlannerEstimate) {
  const config::MissionSetup mission = config::parse_mission(
      tests::quick_mission(), "m.yaml",
      {{"--planner", "planner.name", "skycap"}, {"--set", "limits.max_views", "3"}});
  const session::SurveyRecord record = simulation::run_survey(
      mission.simulation, evaluation::SurveyScene(mission.simulation, "", mission.run.threads), 1,
      1);
  const tests::TestFolder folder;
  geometry::OutputFolder out(folder.path());
  package::stage_package(mission, record, {}, 1, out);
  out.commit();

  const Json estimate =
      Json::parse(tests::read_content(folder.path() / "summary.json"))["estimate"];
  double missing = 0.0;
  for (const auto& [reason, share] : estimate["missing"].items()) {
    EXPECT_GE(share, 0.0) << reason;
    missing += share.get<double>();
  }
  // Areas are floats.
  EXPECT_NEAR(missing + estimate["estimated_coverage"].get<double>(), 1.0, 1e-5);
  EXPECT_EQ(estimate["stop"], "view_limit");
  EXPECT_GT(estimate["next_gain"], 0.0);
  EXPECT_EQ(estimate["noise_m"], record.estimate->noise);

  const geometry::AttributedCloud map = geometry::read_cloud(folder / "coverage.ply");
  ASSERT_EQ(map.colours.size(), map.positions.size());
  const auto is_red = [](const auto& colour) { return colour[0] > 200 && colour[1] < 100; };
  std::size_t predicted = 0;
  for (const survey::surfel::EstimatedPatch& patch : record.estimate->patches) {
    predicted += patch.reason == survey::surfel::MissingReason::never_seen;
  }
  EXPECT_GT(predicted, 0U);
  EXPECT_EQ(std::ranges::count_if(map.colours, is_red), predicted);
}

// One sample of each kind, read back by the general PLY reader.
TEST(Package, WritesGroundTruthCoverage) {
  const package::TrueCoverage truth{
      .samples = {.points = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}},
                  .normals = std::vector<Eigen::Vector3f>(4, Eigen::Vector3f::UnitZ()),
                  .triangles = {0, 0, 0, 0}},
      .is_covered = {1, 0, 0, 0},
      .is_visible = {1, 1, 1, 0},
      .is_attainable = {1, 1, 0, 0}};
  const tests::TestFolder folder;
  geometry::OutputFolder out(folder.path());
  package::stage_package(make_mission(), two_views(), {.truth = truth}, 1, out);
  out.commit();

  const std::string bytes = tests::read_content(folder / "true_coverage.ply");
  geometry::PlyReader reader("true_coverage.ply", bytes);
  const std::vector<std::string_view> names{"x", "nz", "covered", "visible", "attainable"};
  const geometry::PlyTable table = reader.read_element(names);
  EXPECT_THAT(table.columns[0], testing::ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(table.columns[1], testing::Each(1));
  EXPECT_THAT(table.columns[2], testing::ElementsAre(1, 0, 0, 0));
  EXPECT_THAT(table.columns[3], testing::ElementsAre(1, 1, 1, 0));
  EXPECT_THAT(table.columns[4], testing::ElementsAre(1, 1, 0, 0));
  const auto colours = geometry::read_cloud(folder / "true_coverage.ply").colours;
  EXPECT_EQ(std::set(colours.begin(), colours.end()).size(), 4U);  // one colour for each kind
}

TEST(Package, OmitsCoverageMapWithoutEstimate) {
  const tests::TestFolder folder;
  geometry::OutputFolder out(folder.path());
  package::stage_package(make_mission(), two_views(), {}, 1, out);
  out.commit();
  EXPECT_FALSE(std::filesystem::exists(folder / "coverage.ply"));
  EXPECT_TRUE(
      Json::parse(tests::read_content(folder.path() / "summary.json"))["estimate"].is_null());
}

// On a sphere the normal equals the position. For views from the inside it is the opposite.
TEST(CloudNormals, MatchSphereAndFaceSensor) {
  geometry::PointCloud cloud;
  for (const Vector3d& direction : evaluation::fibonacci_directions(5000)) {
    cloud.positions.push_back(direction.cast<float>());
    cloud.views.push_back(direction.z() > 0.0 ? 0 : 1);
  }
  const std::vector<Vector3d> sensors{{0, 0, 100}, {0, 0, 0}};
  const auto normals = package::cloud_normals(cloud, sensors, 0.2, 2);
  ASSERT_GT(cloud.size(), 0U);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3f& p = cloud.positions[i];
    if (std::abs(p.z()) < 0.05F) continue;  // sensors see the rim edge-on, so both signs are valid
    const float towards = p.z() > 0.0F ? 1.0F : -1.0F;
    // The plane of a symmetric cap is exact. Downsampling makes it slightly asymmetric.
    EXPECT_GT(towards * normals[i].dot(p), 0.99F) << "point " << i;
  }
}

TEST(CloudNormals, PointToSensorForIsolatedPoints) {
  geometry::PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {5, 0, 0}};
  cloud.views = {0, 0};
  const std::vector<Vector3d> sensors{{0, 3, 0}};
  const auto normals = package::cloud_normals(cloud, sensors, 0.2, 1);
  EXPECT_EQ(normals[0], Vector3f(0, 1, 0));
}

TEST(CloudNormals, AreEmptyWhenStopped) {
  geometry::PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {5, 0, 0}};
  cloud.views = {0, 0};
  const std::vector<Vector3d> sensors{{0, 3, 0}};
  std::stop_source stop;
  EXPECT_EQ(package::cloud_normals(cloud, sensors, 0.2, 1, stop.get_token()).size(), 2U);
  stop.request_stop();
  EXPECT_TRUE(package::cloud_normals(cloud, sensors, 0.2, 1, stop.get_token()).empty());
}

TEST(OutputFolder, WritesFilesOnlyWhenCommitted) {
  const tests::TestFolder folder;
  const std::filesystem::path results = folder.path() / "results";
  {
    geometry::OutputFolder out(results);
    out.write("a.txt", "a");
  }
  EXPECT_FALSE(std::filesystem::exists(results));
  {
    geometry::OutputFolder out(results);
    out.write("a.txt", "a");
    out.write("b.txt", "b");
    out.commit();
  }
  EXPECT_EQ(tests::read_content(results / "a.txt"), "a");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(results), {}), 2);
}

TEST(OutputFolder, ReportsUnwritableFolders) {
  const tests::TestFolder folder;
  const std::string file = folder.write("file", "");
  for (const std::string& bad : {file, file + "/below", std::string("/proc/skycap")}) {
    try {
      const geometry::OutputFolder out(bad);
      ADD_FAILURE() << bad;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(bad + ": "));
    }
  }
}

// Examples of FIPS 180-4: one block and two blocks.
TEST(Sha256, MatchesStandardExamples) {
  const auto of = [](std::string_view text) {
    return support::sha256(std::as_bytes(std::span(text)));
  };
  EXPECT_EQ(of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

}  // namespace
}  // namespace skycap::missions
