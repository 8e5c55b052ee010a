// Inspection from the mission file to the results and back to the evaluation.
#include "missions/inspection/inspection_mission.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/export/trajectory_file.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "geometry/random_numbers.h"
#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/config/inspection_rules.h"
#include "missions/config/mission_document.h"
#include "missions/config/resolve.h"
#include "missions/inspection/flight_file.h"
#include "missions/inspection/inspection_results.h"
#include "missions/package/package.h"
#include "tests/missions/inspection/block.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing_support::thrown_message;

constexpr const char* block_yaml = R"(
sensor: {photo_camera: mavic_3e_wide}
inspection: {range: 7, share: 0.9, spacing: 0.25, moves: 1500, searches: 2}
prior: [{file: block.obj, role: target, uncertainty: 0.1}]
flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}
)";

class InspectionMissionTest : public testing::Test {
 protected:
  InspectionMissionTest() { write("block.obj", block_obj); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }
  config::MissionSetup read(const std::string& text,
                            const std::vector<config::KeyOverride>& overrides = {}) const {
    write("mission.yaml", text);
    return config::read_mission(folder_.path() / "mission.yaml", overrides);
  }
  std::string message(const std::vector<config::KeyOverride>& overrides) const {
    return thrown_message([&] { read(block_yaml, overrides); });
  }
  static inspection::InspectionMission plan(const config::MissionSetup& setup) {
    const inspection::InspectionSpace space(setup);
    return plan_inspection_mission(setup, space, {}, [](const std::string&) {});
  }

  testing_support::TemporaryFolder folder_;
};

TEST_F(InspectionMissionTest, PlansAVerifiedFlightAroundAMesh) {
  const config::MissionSetup setup = read(block_yaml);
  const inspection::InspectionMission mission = plan(setup);
  EXPECT_TRUE(mission.plan.evaluation.keeps_limits());
  EXPECT_GE(mission.plan.verified_clearance, 2.0);
  EXPECT_GT(mission.plan.evaluation.share(2), 0.7);
  // Twin: exact distances from the mesh, the uncertainty of the prior data, and the ground.
  geometry::Mesh block;
  block.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0},
                    {-2, -2, 5}, {2, -2, 5}, {2, 2, 5}, {-2, 2, 5}};
  block.triangles = {{0, 3, 2}, {0, 2, 1}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                     {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  const geometry::MeshDistance distance(block);
  for (const auto& sample : mission.plan.samples) {
    EXPECT_GE(distance.distance(sample.position), 2.1) << "at " << sample.time << " s";
    EXPECT_GE(sample.position.z(), 2.0) << "at " << sample.time << " s";
  }
}

TEST_F(InspectionMissionTest, WritesAFlightThatItsEvaluationConfirms) {
  const config::MissionSetup setup = read(block_yaml);
  inspection::InspectionMission mission = plan(setup);
  const inspection::InspectionSpace space(setup);
  geometry::OutputFolder folder(folder_.path() / "results");
  stage_inspection_mission(setup, space, mission, folder);
  folder.commit();

  const auto flight = inspection::read_flight_csv(folder.path() / inspection::flight_name);
  ASSERT_EQ(flight.size(), mission.plan.samples.size());
  const auto evaluation = evaluate_inspection(setup, space, flight);
  EXPECT_TRUE(evaluation.keeps_clearance());
  EXPECT_TRUE(evaluation.flight.keeps_limits());
  EXPECT_EQ(evaluation.flight.seen[2], mission.plan.evaluation.seen[2]);

  // Yaw of setpoints is clockwise from north; the reader converts it back.
  const auto states =
      flight::read_trajectory_csv(geometry::read_file(folder.path() / "setpoints.enu.csv"));
  ASSERT_EQ(states.size(), flight.size());
  for (std::size_t i = 0; i < flight.size(); i += 50) {
    EXPECT_LT((states[i].position - flight[i].position).norm(), 1e-3);
    const double yaw = 0.5 * std::numbers::pi - flight[i].yaw;
    EXPECT_NEAR(std::remainder(states[i].yaw - yaw, 2.0 * std::numbers::pi), 0.0, 1e-3);
    EXPECT_NEAR(states[i].pitch, flight[i].pitch, 1e-3);
  }
  const auto cloud = geometry::read_cloud(folder.path() / inspection::structure_name);
  EXPECT_EQ(cloud.positions.size(), mission.plan.cloud.size());

  const auto json =
      nlohmann::json::parse(geometry::read_file(folder.path() / package::summary_name));
  EXPECT_EQ(json.at("kind"), "inspection");
  EXPECT_EQ(json.at("inspection").at("duration_s"), mission.plan.evaluation.duration);
  EXPECT_TRUE(json.at("inspection").at("formats_not_written").contains("plan"));
  EXPECT_THAT(thrown_message([&] { package::read_package(folder.path(), {}); }),
              HasSubstr("describes an inspection, which has no views to stop at"));
}

TEST_F(InspectionMissionTest, PlansAroundAPointCloud) {
  std::vector<Eigen::Vector3f> points;
  for (float a = -1.5F; a <= 1.5F; a += 0.25F) {
    for (float b = 2.0F; b <= 5.0F; b += 0.25F) {
      points.push_back({a, -1.5F, b});
      points.push_back({a, 1.5F, b});
      points.push_back({-1.5F, a, b});
      points.push_back({1.5F, a, b});
    }
  }
  geometry::CloudColumns columns;
  columns.positions = points;
  geometry::write_cloud(folder_.path() / "tower.ply", columns);
  const config::MissionSetup setup = read(R"(
inspection: {range: 7, cloud: tower.ply, share: 0.8, moves: 1500, searches: 1}
flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}
)");
  const inspection::InspectionMission mission = plan(setup);
  double nearest = 1e9;
  for (const auto& sample : mission.plan.samples) {
    for (const Eigen::Vector3f& point : points) {
      nearest = std::min(nearest, (point.cast<double>() - sample.position).norm());
    }
  }
  // The surface between the points is up to a disc radius nearer than they are.
  EXPECT_GE(nearest, 2.0 + static_cast<double>(mission.plan.cloud.median_radius));
}

// Twin: the first point of each voxel, with an ordered set.
TEST_F(InspectionMissionTest, KeepsOnePointPerVoxelOfALargeCloud) {
  geometry::RandomNumbers random(5);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 40'000; ++i) {
    const auto number = [&] { return static_cast<float>(random.between(-3.0, 3.0)); };
    points.push_back({number(), number(), 3.0F});
    if (i % 3 == 0) points.push_back(points.back());
  }
  geometry::CloudColumns columns;
  columns.positions = points;
  geometry::write_cloud(folder_.path() / "roof.ply", columns);
  const inspection::InspectionSpace space(read(R"(
inspection: {range: 7, cloud: roof.ply, spacing: 0.05}
flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}
)"));
  std::set<std::array<double, 3>> used;
  std::vector<Eigen::Vector3f> expected;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d cell = (point.cast<double>() / 0.05).array().floor();
    if (used.insert({cell.x(), cell.y(), cell.z()}).second) expected.push_back(point);
  }
  const auto kept = space.site().points;
  EXPECT_TRUE(std::equal(kept.begin(), kept.end(), expected.begin(), expected.end()));
  EXPECT_LT(expected.size(), points.size());
}

TEST_F(InspectionMissionTest, DerivesLimitsFromTheVehicle) {
  const auto options = config::inspection_options(
      *read(block_yaml, {{"--set", "flight.vehicle", "generic"}}).document);
  EXPECT_NEAR(options.limits.speed, 2.0, 1e-12);
  EXPECT_NEAR(options.limits.yaw_acceleration, 0.349, 1e-3) << "of PX4, less than 30 degrees/s^2";
  EXPECT_NEAR(options.limits.descent, 1.5, 1e-12);
  EXPECT_EQ(options.clearance, 2.0);
}

TEST_F(InspectionMissionTest, RejectsKeysThatDoNotFitAnInspection) {
  EXPECT_THAT(
      message({{"--set", "flight.vehicle", "none"}}),
      EndsWith("key inspection.range requires a vehicle, whose limits the flight keeps; set "
               "flight.vehicle"));
  EXPECT_THAT(message({{"--set", "flight.free_space", "measured"}}),
              HasSubstr("key inspection.range requires flight.free_space: assumed"));
  EXPECT_THAT(message({{"--set", "photo.gsd", "0.01"}}),
              HasSubstr("key photo.gsd conflicts with inspection.range"));
  EXPECT_THAT(message({{"--set", "inspection.max_speed", "40"}}),
              HasSubstr("key inspection.max_speed must be at most the limit of the vehicle"));
  constexpr const char* without_range = R"(
sensor: {photo_camera: mavic_3e_wide}
inspection: {share: 0.9}
photo: {gsd: 0.01}
prior: [{file: block.obj, role: target, uncertainty: 0.1}]
)";
  EXPECT_THAT(thrown_message([&] { read(without_range); }),
              HasSubstr("key inspection.share requires inspection.range"));
}

TEST_F(InspectionMissionTest, ReadsFlightsOfOtherPrograms) {
  write("a.txt", "# made elsewhere\nt;x;y;z;yaw;pitch\n0;1;2;3;0.5;-0.1\n\n0.1;1;2;3;0.6;-0.2\n");
  const auto flight = inspection::read_flight_csv(folder_.path() / "a.txt");
  ASSERT_EQ(flight.size(), 2U);
  EXPECT_EQ(flight[1].time, 0.1);
  EXPECT_EQ(flight[1].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(flight[1].yaw, 0.6);
  EXPECT_EQ(flight[1].pitch, -0.2);
  const auto complaint = [&](const std::string& text) {
    write("b.txt", text);
    return thrown_message([&] { inspection::read_flight_csv(folder_.path() / "b.txt"); });
  };
  EXPECT_THAT(complaint("0 1 2 3 0 0\n0.1 1 2 3\n"),
              EndsWith("b.txt:2: expected six numbers: t, x, y, z, yaw, pitch"));
  EXPECT_THAT(complaint("0 1 2 3 0 0\n0 1 2 3 0 0\n"), EndsWith("b.txt:2: times must ascend"));
  EXPECT_THAT(complaint("0 1 2 nan 0 0\n1 1 2 inf 0 0\n"),
              EndsWith("b.txt:2: expected six numbers: t, x, y, z, yaw, pitch"));
  EXPECT_THAT(complaint(""), HasSubstr("contains no samples of a flight"));
}

}  // namespace
}  // namespace skycap::missions
