#include "missions/simulation/survey_runner.h"

#include <algorithm>
#include <chrono>
#include <random>
#include <stop_token>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/batch/benchmark/trials.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/coverage.h"
#include "survey/planners/planner_options.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"

namespace skycap::missions {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using tests::quick_mission;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

TEST(SurveyScene, StartsAtConfiguredOrRandomView) {
  const config::MissionSetup mission =
      config::parse_mission(quick_mission(), "m.yaml", {{"--set", "evaluation.samples", "100000"}});
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const geometry::View a = scene.first_view(1), b = scene.first_view(2);
  EXPECT_EQ(a.position, scene.first_view(1).position);
  EXPECT_GT((a.position - b.position).norm(), 0.1);  // another direction
  // Both views are at d + mean distance from the same centroid and look at it. Their viewing lines
  // intersect there.
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double mean_distance = 0.0;
  const auto& points = scene.samples().points;
  for (const auto& point : points) centroid += point.cast<double>() / double(points.size());
  for (const auto& point : points) {
    mean_distance += (point.cast<double>() - centroid).norm() / double(points.size());
  }
  for (const geometry::View& view : {a, b}) {
    const double distance = scene.view_distance() + mean_distance;
    EXPECT_LT((view.position + distance * view.direction - centroid).norm(), 1e-6);
  }

  const config::MissionSetup given = config::parse_mission(
      quick_mission("start: {position: [0, 3, 1], look_at: [0, 0, 1]}"), "m.yaml");
  const geometry::View view = evaluation::SurveyScene(given.simulation, "", 0).first_view(1);
  EXPECT_EQ(view.position, Eigen::Vector3d(0, 3, 1));
  EXPECT_LT((view.direction + Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

// Results depend on the seed and the order of draws. The start must be the same with all compilers.
TEST(SurveyScene, DrawsRandomStartsInDefinedOrder) {
  const config::MissionSetup mission = config::parse_mission(quick_mission(), "m.yaml");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Eigen::Vector3d from_centre;
    for (const int axis : {2, 1, 0}) from_centre[axis] = normal(random);
    EXPECT_LT((scene.first_view(seed).direction + from_centre.normalized()).norm(), 1e-12) << seed;
  }
}

TEST(SurveyScene, KeepsRandomStartsAboveGroundClearance) {
  const config::MissionSetup mission = config::parse_mission(
      quick_mission(), "m.yaml", {{"--set", "limits.ground_clearance", "0.5"}});
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    EXPECT_GE(scene.first_view(seed).position.z(), 0.5);
  }
}

/// Returns all values of planner.name except users' own planners, which require a file.
std::vector<std::string> planner_names() {
  std::vector<std::string> names;
  for (const config::Key& key : config::mission_keys()) {
    if (key.path == "planner.name") names.assign(key.choices.begin(), key.choices.end());
  }
  std::erase(names, "external");
  return names;
}

// Each planner that a mission can name surveys the scene of the quick mission. Patterns see only a
// part of it.
TEST(RunSurvey, CoversSceneWithEveryPlanner) {
  EXPECT_EQ(planner_names().size(), 20U);
  for (const std::string& name : planner_names()) {
    const config::MissionSetup mission = config::parse_mission(
        quick_mission(), "m.yaml",
        {{"--planner", "planner.name", name}, {"--set", "volumetric.view_limit", "8"}});
    const session::SurveyRecord record = simulation::run_survey(
        mission.simulation, evaluation::SurveyScene(mission.simulation, "", 0), 1, 1);
    const bool is_pattern = survey::pattern_of(*survey::planner_called(name)).has_value();
    EXPECT_GT(record.coverage(), is_pattern ? 0.2 : 0.6) << name;
    EXPECT_GE(record.views.size(), 2U) << name;
  }
}

// The fence leaves a half plane, the prism removes a part of it, and the gimbal only looks down.
TEST(RunSurvey, KeepsSiteAndLimitsWithEveryPlanner) {
  const std::string site =
      "site:\n"
      "  geofence: [[-9, -9], [9, -9], [9, 0.5], [-9, 0.5]]\n"
      "  no_fly: [{corners: [[1, -3], [3, -3], [3, 1], [1, 1]], floor: -5, ceiling: 1.5}]\n"
      "  min_height: 0.2\n"
      "  max_height: 1.9\n";
  std::size_t grids = 0;
  for (const std::string& name : testing_support::not_empty(planner_names())) {
    const config::MissionSetup mission =
        config::parse_mission(quick_mission(site), "m.yaml",
                              {{"--planner", "planner.name", name},
                               {"--set", "volumetric.view_limit", "8"},
                               {"--set", "limits.stand_off", "0.4"},
                               {"--set", "limits.max_pitch_deg", "0"}});
    const evaluation::SurveyScene scene(mission.simulation, "", 0);
    if (survey::pattern_of(*survey::planner_called(name))) {
      const std::string message = testing_support::thrown_message(
          [&] { simulation::run_survey(mission.simulation, scene, 1, 1); });
      if (!message.empty()) {  // grids are above the maximum height
        EXPECT_THAT(message, HasSubstr("within the limits of pitch, height and airspace")) << name;
        ++grids;
        continue;
      }
    }
    const session::SurveyRecord record = simulation::run_survey(mission.simulation, scene, 1, 1);
    const geometry::MeshDistance truth(scene.model());
    const survey::ViewLimits& limits = mission.survey().planner.limits;
    EXPECT_GE(record.views.size(), 2U) << name;
    for (const session::EvaluatedView& evaluated : record.views) {
      const geometry::View& view = evaluated.surveyed.view;
      EXPECT_TRUE(limits.allow(view)) << name << " at " << view.position.transpose();
      // With 0.03 m noise, measurements are closer to the sensor or farther away than the ground
      // truth.
      EXPECT_GT(truth.distance(view.position), 0.4 - 0.1) << name;
    }
  }
  EXPECT_LE(grids, 3U);  // nadir, oblique, corridor
}

TEST(MakePlanner, RequiresSphereForVolumetricPlanner) {
  const config::KeyOverride name{"", "planner.name", "oa"};
  const auto make_test_planner = [](const std::vector<config::KeyOverride>& keys,
                                    const survey::PlannerRun& run) {
    const config::MissionSetup mission = config::parse_mission(quick_mission(), "m.yaml", keys);
    return survey::make_planner(mission.survey().planner, run);
  };
  EXPECT_THAT(testing_support::thrown_message([&] { make_test_planner({name}, {}); }),
              HasSubstr("volumetric.sphere_centre"));
  EXPECT_NE(make_test_planner({name}, {.sphere = survey::ViewSphere{.radius = 2.0}}), nullptr);
  EXPECT_NE(make_test_planner({name,
                               {"", "volumetric.sphere_centre", "[0, 0, 0]"},
                               {"", "volumetric.sphere_radius", "2"}},
                              {}),
            nullptr);
}

TEST(RunSurvey, EndsAtDistanceAndViewLimits) {
  for (const char* name : {"see++", "skycap"}) {
    const auto record_with = [&](const char* key, const char* value) {
      const config::MissionSetup mission = config::parse_mission(
          quick_mission(), "m.yaml", {{"--planner", "planner.name", name}, {"--set", key, value}});
      return simulation::run_survey(mission.simulation,
                                    evaluation::SurveyScene(mission.simulation, "", 0), 1, 1);
    };
    const session::SurveyRecord by_length = record_with("limits.max_distance", "6");
    EXPECT_EQ(by_length.stop_reason, survey::StopReason::distance_limit) << name;
    EXPECT_LE(by_length.distance(), 6.0) << name;

    const session::SurveyRecord by_time = record_with("limits.max_minutes", "0.4");
    EXPECT_EQ(by_time.stop_reason, survey::StopReason::time_limit) << name;
    // 5 m/s and 5 s for each view, within 24 s.
    EXPECT_LE(by_time.distance() / 5.0 + 5.0 * static_cast<double>(by_time.views.size()), 24.0);
    EXPECT_GE(by_time.views.size(), 3U) << name;

    const session::SurveyRecord by_views = record_with("limits.max_views", "3");
    EXPECT_EQ(by_views.stop_reason, survey::StopReason::view_limit) << name;
  }
}

// Admissible positions are those within the mission's limits. From above, only the upper surfaces
// are visible.
TEST(SurveyScene, CountsSurfaceSeenFromAdmissiblePositions) {
  const auto share = [](const std::string& more) {
    const config::MissionSetup mission = config::parse_mission(quick_mission(more), "m.yaml");
    const std::vector<std::uint8_t> visible =
        evaluation::SurveyScene(mission.simulation, "", 0).visible(1);
    return static_cast<double>(std::ranges::count(visible, 1)) / double(visible.size());
  };
  const double anywhere = share(""), above = share("site: {min_height: 1.0}");
  const double south = share("site: {geofence: [[-9, -9], [9, -9], [9, -1.5], [-9, -1.5]]}");
  EXPECT_GT(anywhere, 0.75);  // the rest is inside the pot
  EXPECT_LT(above, 0.9 * anywhere);
  EXPECT_LT(south, 0.9 * anywhere);
  EXPECT_GT(south, 0.3 * anywhere);
}

// Coverage grows with the views and ends with that of the final cloud.
TEST(RunSurvey, EvaluatesEveryView) {
  const config::MissionSetup mission = config::parse_mission(quick_mission(), "m.yaml");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  std::size_t reported = 0;
  const session::SurveyRecord record = simulation::run_survey(
      mission.simulation, scene, 3, 1, {}, [&](const session::EvaluatedView&) { ++reported; });
  ASSERT_GT(record.views.size(), 2U);
  EXPECT_EQ(reported, record.views.size());
  EXPECT_EQ(record.views.back().surveyed.points, record.cloud.size());
  for (std::size_t i = 1; i < record.views.size(); ++i) {
    EXPECT_GE(record.views[i].coverage, record.views[i - 1].coverage);
  }
  evaluation::CoverageMeter meter(scene.samples().points,
                                  mission.evaluation().registration_distance);
  meter.add(record.cloud.positions);
  EXPECT_EQ(record.coverage(), meter.share());
  EXPECT_GT(record.coverage(), 0.5);  // requires more than one view
}

// For a stop at any time, the cloud contains exactly the points of the reported views.
TEST(RunSurvey, KeepsPointsOfReportedViewsWhenStopped) {
  const config::MissionSetup mission = config::parse_mission(
      quick_mission(), "m.yaml",
      {{"--planner", "planner.name", "rsv"}, {"--set", "volumetric.view_limit", "100"}});
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  int stopped = 0;
  for (const int delay : {1, 5, 20, 60, 120}) {
    std::stop_source stop;
    std::jthread finger;
    const session::SurveyRecord record = simulation::run_survey(
        mission.simulation, scene, 1, 1, stop.get_token(), [&](const session::EvaluatedView&) {
          if (finger.joinable()) return;
          finger = std::jthread([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(delay));
            stop.request_stop();
          });
        });
    // Otherwise the survey had already ended.
    if (record.stop_reason == survey::StopReason::interrupted) ++stopped;
    ASSERT_FALSE(record.views.empty());
    EXPECT_EQ(record.cloud.size(), record.views.back().surveyed.points);
    EXPECT_LT(record.cloud.views.back(), record.views.size());
  }
  EXPECT_GT(stopped, 0);
}

TEST(Plan, WritesSameBytesForAnyThreadCount) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  for (const char* threads : {"1", "2", "3"}) {
    const auto run = run_skycap({"plan", mission, "--out", folder / threads, "--threads", threads});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  for (const char* file : {"views.csv", "cloud.ply", "trajectory.tum"}) {
    const std::string first = read_content(folder.path() / "1" / file);
    EXPECT_GT(first.size(), 100U);
    EXPECT_EQ(first, read_content(folder.path() / "2" / file)) << file;
    EXPECT_EQ(first, read_content(folder.path() / "3" / file)) << file;
  }
}

TEST(Plan, PlansDifferentSurveyForDifferentSeed) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  for (const char* seed : {"1", "2"}) {
    ASSERT_EQ(run_skycap({"plan", mission, "--out", folder / seed, "--seed", seed}).exit_code, 0);
  }
  EXPECT_NE(read_content(folder.path() / "1" / "views.csv"),
            read_content(folder.path() / "2" / "views.csv"));
}

// A stop is requested during the first view. The view is completed and kept.
TEST(Plan, WritesIncompletePackageWhenInterrupted) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  std::stop_source stop;
  stop.request_stop();
  const auto run = run_skycap({"plan", mission, "--out", folder / "out"}, false, stop.get_token());
  EXPECT_EQ(run.exit_code, 1);
  const json summary = json::parse(read_content(folder.path() / "out" / "summary.json"));
  EXPECT_EQ(summary["complete"], false);
  EXPECT_EQ(summary["stop_reason"], "interrupted");
  EXPECT_EQ(summary["views"], 1);
  for (const char* file : {"views.csv", "cloud.ply", "trajectory.tum"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / file)) << file;
  }
  // The user waits for the program to end, and normals take as long as views.
  EXPECT_THAT(read_content(folder.path() / "out" / "cloud.ply"),
              Not(HasSubstr("property float nx")));
}

TEST(Plan, ShowsProgressOnlyOnTerminalUnlessQuiet) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const std::vector<std::string> plain{"plan",         mission,       "--out",
                                       folder / "out", "--max-views", "2"};
  const auto on_terminal = run_skycap(plain, true);
  EXPECT_THAT(on_terminal.err, HasSubstr("view 2 of at most 2, "));
  EXPECT_THAT(on_terminal.err, HasSubstr("frontiers"));
  EXPECT_THAT(on_terminal.out, HasSubstr("view_limit after 2 views"));
  EXPECT_EQ(run_skycap(plain).err, "");

  std::vector<std::string> quiet = plain;
  quiet.push_back("--quiet");
  const auto silent = run_skycap(quiet, true);
  EXPECT_EQ(silent.out + silent.err, "");
  EXPECT_EQ(silent.exit_code, 0);

  std::vector<std::string> verbose = plain;
  verbose.push_back("--verbose");
  EXPECT_THAT(run_skycap(verbose).err, HasSubstr("insert"));
}

// Parallel trials equal separate surveys.
TEST(Plan, RunsTrialsEqualToSeparateSurveys) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const std::vector<std::string> trials{"plan", mission,  "--out", folder / "t", "--trials",
                                        "3",    "--seed", "5",     "--threads",  "2"};
  ASSERT_EQ(run_skycap(trials).exit_code, 0);
  std::istringstream csv(read_content(folder.path() / "t" / "trials.csv"));
  std::string line;
  std::getline(csv, line);
  for (const char* seed : {"5", "6", "7"}) {
    ASSERT_EQ(run_skycap({"plan", mission, "--out", folder / "s", "--seed", seed}).exit_code, 0);
    const json summary = json::parse(read_content(folder.path() / "s" / "summary.json"));
    ASSERT_TRUE(std::getline(csv, line));
    EXPECT_THAT(line, testing::StartsWith(std::string(seed) + "," +
                                          summary["stop_reason"].get<std::string>() + "," +
                                          std::to_string(summary["views"].get<int>()) + "," +
                                          summary["coverage"].dump() + ","));
  }
}

// SEE++ without its two extensions is bitwise equal to SEE.
TEST(Plan, MatchesSeeWithoutOptimiserAndGraph) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  ASSERT_EQ(run_skycap({"plan", mission, "--out", folder / "see", "--planner", "see"}).exit_code,
            0);
  ASSERT_EQ(run_skycap({"plan", mission, "--out", folder / "without", "--set",
                        "planner.optimise_views=false", "--set", "planner.visibility_graph=false"})
                .exit_code,
            0);
  EXPECT_EQ(read_content(folder.path() / "see" / "cloud.ply"),
            read_content(folder.path() / "without" / "cloud.ply"));
}

// `evaluate` computes the same coverage from files as `plan` during the survey.
TEST(Evaluate, MatchesCoverageOfPlan) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  ASSERT_EQ(run_skycap({"plan", mission, "--out", folder / "out"}).exit_code, 0);
  const json summary = json::parse(read_content(folder.path() / "out" / "summary.json"));
  const auto run =
      run_skycap({"evaluate", "--cloud", folder / "out/cloud.ply", "--model", mission, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json evaluation = json::parse(run.out);
  EXPECT_EQ(evaluation["coverage"], summary["coverage"]);
  EXPECT_EQ(evaluation["points"], summary["points"]);
  // Isotropic noise of 3 cm moves points off the surface by 3 cm rms, and by slightly less at
  // edges.
  EXPECT_NEAR(evaluation["distance_to_model_m"]["root_mean_square"], 0.03, 0.008);
}

TEST(Plan, KeepsModelCopiesInSettings) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const auto run = run_skycap({"plan", mission, "--set", "scene.copies=[[1.5, 0, 90]]",
                               "--max-views", "2", "--out", folder / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json summary = json::parse(read_content(folder.path() / "out" / "summary.json"));
  EXPECT_EQ(summary["settings"]["scene.copies"], json::parse("[[1.5, 0.0, 90.0]]"));
}

TEST(Model, HasDetailLevelsOfSameShape) {
  const TestFolder folder;
  const auto printed = [](const std::string& model, const char* detail) {
    return run_skycap({"model", model, "--detail", detail});
  };
  const auto number_after = [](const std::string& text, const std::string& word) {
    return std::stod(text.substr(text.find(word) + word.size()));
  };
  const auto coarse = printed("radcliffe-camera", "coarse");
  const auto fine = printed("radcliffe-camera", "fine");
  // Number of triangles.
  EXPECT_GT(number_after(fine.out, ": "), 10.0 * number_after(coarse.out, ": "));
  EXPECT_THAT(coarse.out, HasSubstr(" x 40, area"));
  EXPECT_THAT(fine.out, HasSubstr(" x 40, area"));
  // Coarse ornaments are plain boxes and curves with few segments.
  const double area = number_after(fine.out, "area ");
  EXPECT_NEAR(number_after(coarse.out, "area "), area, 0.25 * area);

  const std::string mission = folder.write("m.yaml", quick_mission());
  EXPECT_NE(printed(mission, "coarse").out, printed(mission, "fine").out);

  const auto rejected = printed("scan.ply", "fine");
  EXPECT_EQ(rejected.exit_code, 2);
  EXPECT_THAT(rejected.err,
              HasSubstr("--detail requires a builtin model; scan.ply has a fixed level of detail"));
  EXPECT_EQ(printed("radcliffe-camera", "finest").exit_code, 2);
}

TEST(Model, WritesSceneOfMission) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const auto run = run_skycap({"model", mission, "--out", folder / "scene.ply"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("1 x 0.6"));  // metres; the teapot has 6.434 x 4 x 3.15 units
  EXPECT_THAT(run_skycap({"model", folder / "scene.ply"}).out, HasSubstr("1 x 0.6"));
}

}  // namespace
}  // namespace skycap::missions
