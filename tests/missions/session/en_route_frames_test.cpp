#include "missions/session/en_route_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "flight/paths/path.h"
#include "flight/route/route.h"
#include "geometry/io/cloud_io.h"
#include "missions/config/resolve.h"
#include "missions/package/package.h"
#include "missions/simulation/survey_runner.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using geometry::View;
using testing::HasSubstr;
using tests::flight_mission;

config::MissionSetup mission_with(const std::string& key = "", const std::string& value = "") {
  std::vector<config::KeyOverride> overrides{{"--set", "sensor.capture", "moving"}};
  if (!key.empty()) overrides.push_back({"--set", key, value});
  return config::parse_mission(flight_mission(), "m.yaml", overrides);
}

/// Returns the distance of a position from a path.
double cross_track_error(const Vector3d& position, const std::vector<Vector3d>& path) {
  double min = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vector3d along = path[i] - path[i - 1];
    const double share =
        std::clamp((position - path[i - 1]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    min = std::min(min, (position - path[i - 1] - share * along).norm());
  }
  return min;
}

const View west{{0, 0, 10}, -Vector3d::UnitX()};
const View north_down{{20, 20, 10}, Vector3d(0, 1, -1).normalized()};

TEST(EnRouteFrames, FollowPathNoFasterThanVehicle) {
  const config::MissionSetup mission = mission_with();
  const session::LegMotion motion(mission.flight());
  const session::ExecutedLeg path{{{0, 0, 10}, {20, 0, 10}, {20, 20, 10}}, 2.0};
  for (const double period : {0.25, 1.0, 2.5}) {
    const auto frames = motion.frames(path, west, north_down, period);
    const double time = motion.time(path, west, north_down);
    EXPECT_NEAR(static_cast<double>(frames.size()), time / period, 2.0) << period;
    double travelled = 0.0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Vector3d& position = frames[i].view.position;
      EXPECT_LT(cross_track_error(position, path.points), 1e-9);
      const double now = position.x() + position.y();  // progress around the corner
      EXPECT_GT(now, travelled);
      EXPECT_LE(now - travelled, mission.flight().cruise_speed * period + 1e-9);
      travelled = now;
      const Vector3d& velocity = frames[i].velocity;
      EXPECT_LE(velocity.norm(), mission.flight().cruise_speed + 1e-9);
      EXPECT_NEAR(frames[i].time, static_cast<double>(i + 1) * period, 1e-9);
    }
    EXPECT_LT(travelled, 40.0);
  }
}

TEST(EnRouteFrames, TurnEvenlyAlongShorterArc) {
  const session::LegMotion motion(mission_with().flight());
  const session::ExecutedLeg path{{{0, 0, 10}, {40, 0, 10}}, 2.0};
  const View south_east{{0, 0, 10}, Vector3d(1, -1, 0).normalized()};
  const View north_east_down{{40, 0, 10}, Vector3d(1, 1, -std::numbers::sqrt2).normalized()};
  const auto frames = motion.frames(path, south_east, north_east_down, 0.5);
  ASSERT_GT(frames.size(), 10U);
  const double time = motion.time(path, south_east, north_east_down);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double share = 0.5 * static_cast<double>(i + 1) / time;
    const Vector3d& direction = frames[i].view.direction;
    EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
    EXPECT_NEAR(std::atan2(direction.y(), direction.x()), (share - 0.5) * std::numbers::pi / 2.0,
                1e-9);
    EXPECT_NEAR(std::asin(direction.z()), -share * std::numbers::pi / 4.0, 1e-9);
  }
}

TEST(EnRouteFrames, LookAtSceneWhenBothViewsDo) {
  const session::LegMotion motion(mission_with().flight());
  const Vector3d scene(50, 60, 5);
  const View from = geometry::look_at({0, 0, 20}, scene),
             to = geometry::look_at({0, 30, 20}, scene);
  for (const auto& [frame, velocity, time, stretch] : testing_support::not_empty(
           motion.frames({{from.position, to.position}, 2.0}, from, to, 1.0))) {
    const Vector3d expected = (scene - frame.position).normalized();
    EXPECT_LT(std::acos(expected.dot(frame.direction)), 0.1);
  }
}

// Between frames 0.1 s apart, the position changes according to the velocities.
TEST(EnRouteFrames, MoveAccordingToTheirVelocities) {
  const session::LegMotion motion(mission_with().flight());
  const auto frames = motion.frames({{{0, 0, 10}, {30, 0, 20}}, 2.0}, west, west, 0.1);
  ASSERT_GT(frames.size(), 50U);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Vector3d mean = 0.5 * (frames[i - 1].velocity + frames[i].velocity);
    const Vector3d moved = frames[i].view.position - frames[i - 1].view.position;
    EXPECT_LT((moved - 0.1 * mean).norm(), 0.01) << i;
  }
}

TEST(EnRouteFrames, AreEmptyOnPathShorterThanPeriod) {
  const session::LegMotion motion(mission_with().flight());
  EXPECT_TRUE(motion.frames({{{0, 0, 10}, {0.5, 0, 10}}, 2.0}, west, west, 60.0).empty());
  EXPECT_TRUE(motion.frames({{{0, 0, 10}, {0, 0, 10}}, 2.0}, west, west, 1.0).empty());
}

// Distance over speed, a ramp at both ends and a stop at the corner, then rests and the climb from
// the pad.
TEST(EnRouteFrames, HaveTimesOfVehicleMotion) {
  const config::MissionSetup mission = mission_with();
  const session::LegMotion motion(mission.flight());
  const flight::Motion vehicle(mission.flight().required_vehicle(),
                               mission.flight().route(Vector3d::Zero()).conditions);
  const session::ExecutedLeg corner{{{0, 0, 10}, {20, 0, 10}, {20, 20, 10}}, 2.0};
  const View same{{20, 20, 10}, west.direction};
  const double one = vehicle.leg_time({20, 0, 0});
  EXPECT_NEAR(motion.time(corner, west, same), 2.0 * one + flight::corner_hold, 1e-9);
  const double rest = mission.flight().rest_before() + mission.flight().rest_after();
  const double start = vehicle.takeoff_time(mission.flight().climb());
  EXPECT_NEAR(motion.survey_times({corner, corner}, {same, same}).back(),
              start + flight::corner_hold + 2.0 * (2.0 * one + flight::corner_hold + rest), 1e-9);
}

TEST(MovingSurvey, ReachesSameCoverageInLessTime) {
  const config::MissionSetup stops = config::parse_mission(flight_mission(), "m.yaml");
  // The en-route frames have observed much of the surface, so that a stop gains less.
  const config::MissionSetup moving = mission_with("planner.min_gain", "0.01");
  const evaluation::SurveyScene scene(moving.simulation, "", 0);
  double standing_time = 0.0, moving_time = 0.0, standing_coverage = 0.0, moving_coverage = 0.0;
  const std::vector<std::uint64_t> seeds{1, 2, 3};
  for (const std::uint64_t seed : seeds) {
    const session::SurveyRecord standing = simulation::run_survey(stops.simulation, scene, seed, 2),
                                passing = simulation::run_survey(moving.simulation, scene, seed, 2);
    EXPECT_EQ(standing.en_route_frames(), 0U);
    EXPECT_GT(passing.en_route_frames(), 10U);
    standing_time += standing.flight_record->time();
    moving_time += passing.flight_record->time();
    standing_coverage += standing.coverage();
    moving_coverage += passing.coverage();
  }
  EXPECT_LT(moving_time, standing_time);
  EXPECT_GT(moving_coverage, standing_coverage - 0.01 * static_cast<double>(seeds.size()));
}

TEST(MovingSurvey, IsSameForAnyThreadCount) {
  const config::MissionSetup mission = mission_with("limits.max_views", "4");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const session::SurveyRecord one = simulation::run_survey(mission.simulation, scene, 1, 1),
                              two = simulation::run_survey(mission.simulation, scene, 1, 2);
  EXPECT_EQ(package::views_csv(one), package::views_csv(two));
  EXPECT_EQ(one.cloud.positions, two.cloud.positions);
  EXPECT_EQ(one.flight_record->measured->free_volume(), two.flight_record->measured->free_volume());
}

TEST(MovingSurvey, RecordsScanOfEachPoint) {
  const config::MissionSetup mission = mission_with("limits.max_views", "4");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const session::SurveyRecord record = simulation::run_survey(mission.simulation, scene, 1, 2);
  ASSERT_EQ(record.scans.size(), record.views.size() + record.en_route_frames());
  ASSERT_EQ(record.cloud.views.size(), record.cloud.positions.size());
  std::vector<bool> brought(record.scans.size(), false);
  for (const std::uint32_t scan : record.cloud.views) brought.at(scan) = true;
  std::size_t scan = 0;
  for (std::size_t i = 0; i < record.views.size(); ++i) {
    const survey::SurveyedView& surveyed_view = record.views[i].surveyed;
    for (const View& frame : surveyed_view.en_route.views) {
      EXPECT_LT(cross_track_error(frame.position, record.flight_record->legs[i].points), 1e-9);
      EXPECT_EQ(record.scans[scan].view, i);
      EXPECT_EQ(record.scans[scan++].position, frame.position);
    }
    EXPECT_EQ(record.scans[scan].position, surveyed_view.view.position);
    EXPECT_EQ(record.scans[scan++].view, i);
  }
  EXPECT_TRUE(brought.front());
  EXPECT_GT(std::ranges::count(brought, true), static_cast<std::ptrdiff_t>(record.views.size()));
}

TEST(MovingSurvey, WritesDestinationViewOfEachPoint) {
  const tests::TestFolder folder;
  const std::string mission = folder.write("m.yaml", flight_mission());
  const auto run = tests::run_skycap({"plan", mission, "--set", "sensor.capture=moving", "--set",
                                      "limits.max_views=3", "--out", folder / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(" en-route frames, motion blur up to "));
  const auto summary = nlohmann::json::parse(tests::read_content(folder / "out/summary.json"));
  EXPECT_EQ(summary["per_view"][0]["en_route_frames"], 0);
  EXPECT_GT(summary["per_view"][1]["en_route_frames"], 0);
  EXPECT_GT(summary["flight"]["survey"]["duration_s"],
            summary["flight"]["survey"]["length_m"].get<double>() / 4.0);
  const auto cloud = geometry::read_cloud(folder / "out/cloud.ply");
  ASSERT_EQ(cloud.views.size(), cloud.positions.size());
  EXPECT_EQ(*std::ranges::max_element(cloud.views), summary["views"].get<unsigned>() - 1);
}

std::string rejection_message(const std::string& text,
                              const std::vector<config::KeyOverride>& keys) {
  return testing_support::thrown_message([&] { config::parse_mission(text, "m.yaml", keys); });
}

TEST(MovingSurvey, RequiresVehicleAndPlannerWithEnRouteScans) {
  const config::KeyOverride moving{"--set", "sensor.capture", "moving"};
  EXPECT_THAT(rejection_message(flight_mission(), {moving, {"--planner", "planner.name", "see++"}}),
              HasSubstr("sensor.capture: moving requires a planner that uses"));
  EXPECT_THAT(rejection_message("scene: {model: 'builtin:teapot'}\n"
                                "evaluation: {coverage_distance: 0.005}\n",
                                {moving}),
              HasSubstr("sensor.capture: moving requires a vehicle"));
  EXPECT_THAT(rejection_message(flight_mission(), {{"--set", "sensor.frame_period", "2"}}),
              HasSubstr("sensor.frame_period requires sensor.capture: moving"));
}

}  // namespace
}  // namespace skycap::missions
