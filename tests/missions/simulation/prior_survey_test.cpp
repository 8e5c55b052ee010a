// Surveys with prior data: obstacles, predicted surfaces, and their records in packages.
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/mesh_io.h"
#include "missions/config/resolve.h"
#include "missions/package/package.h"
#include "missions/package/target_coverage.h"
#include "missions/simulation/survey_runner.h"
#include "tests/flight/scenes.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"

namespace skycap::missions {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::json;
using testing::HasSubstr;
using tests::flight_mission;
using tests::read_content;
using tests::TestFolder;

/// Splits the line at spaces and runs the program.
tests::ProgramRun run_skycap(const std::string& line) {
  std::istringstream words(line);
  return tests::run_skycap(std::vector<std::string>(std::istream_iterator<std::string>(words), {}));
}

/// A mast between the pad of flight_mission() and its scene, where the first leg would otherwise
/// be.
const AlignedBox3d mast{Vector3d(-66, -3, 0), Vector3d(-64, 3, 25)};
constexpr double uncertainty = 0.7;

std::string with_obstacle(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "mast.obj";
  geometry::write_mesh(file, flight::scenes::box(mast.min(), mast.max()));
  return flight_mission("prior: [{file: '" + file.string() +
                        "', role: obstacle, uncertainty: 0.7}]\n");
}

/// Returns the minimum distance of points every 1 cm on a path from a box. It exceeds the true
/// distance by at most 1 cm.
double nearest(const std::vector<Vector3d>& flown_path, const AlignedBox3d& box) {
  double min = 1e9;
  for (std::size_t i = 1; i < flown_path.size(); ++i) {
    const auto steps = static_cast<int>((flown_path[i] - flown_path[i - 1]).norm() / 0.01) + 1;
    for (int k = 0; k <= steps; ++k) {
      const Vector3d at = flown_path[i - 1] +
                          (flown_path[i] - flown_path[i - 1]) * (static_cast<double>(k) / steps);
      min = std::min(min, box.exteriorDistance(at));
    }
  }
  return min;
}

TEST(PriorSurvey, KeepsLegsClearOfUnmeasuredObstacles) {
  const TestFolder folder;
  const config::MissionSetup mission =
      config::parse_mission(with_obstacle(folder.path()), "m.yaml");
  const config::MissionSetup without = config::parse_mission(flight_mission(), "m.yaml");
  bool was_obstructed = false;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const session::SurveyRecord record = simulation::run_survey(
        mission.simulation, evaluation::SurveyScene(mission.simulation, "", 0), seed, 1);
    ASSERT_GT(record.views.size(), 3U);
    for (const session::ExecutedLeg& leg : testing_support::not_empty(record.flight_record->legs)) {
      EXPECT_GE(nearest(leg.points, mast), mission.flight().clearance + uncertainty);
    }
    const session::SurveyRecord other = simulation::run_survey(
        without.simulation, evaluation::SurveyScene(without.simulation, "", 0), seed, 1);
    for (const session::ExecutedLeg& leg : other.flight_record->legs) {
      was_obstructed |= nearest(leg.points, mast) < mission.flight().clearance + uncertainty;
    }
  }
  EXPECT_TRUE(was_obstructed) << "else the test says nothing";
}

// From the mission file to the exported route and its check by `check --route`.
TEST(PriorSurvey, PlansExportsAndChecksWithObstacles) {
  const TestFolder folder;
  std::ofstream(folder.path() / "m.yaml") << with_obstacle(folder.path());
  std::ofstream(folder.path() / "bare.yaml") << flight_mission();
  const std::string path = folder.path().string();
  ASSERT_EQ(run_skycap("plan " + path + "/m.yaml --quiet --out " + path + "/with").exit_code, 0);
  ASSERT_EQ(run_skycap("plan " + path + "/bare.yaml --quiet --out " + path + "/bare").exit_code, 0);
  const auto with = run_skycap("check " + path + "/m.yaml --route " + path + "/with/mission.plan");
  EXPECT_EQ(with.exit_code, 0) << with.out;
  const auto bare = run_skycap("check " + path + "/m.yaml --route " + path + "/bare/mission.plan");
  EXPECT_EQ(bare.exit_code, 1) << bare.out;
  EXPECT_THAT(bare.out, HasSubstr("the prior mast.obj"));
  EXPECT_THAT(run_skycap("check " + path + "/m.yaml").out, HasSubstr("mast.obj: obstacle"));
  EXPECT_EQ(run_skycap("export " + path + "/with --format plan --out " + path + "/again").exit_code,
            0);
  // A package requires the obstacle file with which it was planned.
  std::filesystem::remove(folder.path() / "mast.obj");
  const auto gone = run_skycap("export " + path + "/with --format plan --out " + path + "/gone");
  EXPECT_NE(gone.exit_code, 0);
  EXPECT_THAT(gone.err, HasSubstr("mast.obj"));
}

TEST(PriorSurvey, NamesKeysOfInvalidSources) {
  const auto error_message = [](const std::string& prior) {
    return testing_support::thrown_message(
        [&] { config::parse_mission(flight_mission("prior: [" + prior + "]\n"), "m.yaml"); });
  };
  EXPECT_THAT(error_message("{file: none.obj, role: target}"),
              testing::MatchesRegex("m.yaml:[0-9]+: key prior.0..file: .*none.obj.*"));
  EXPECT_THAT(
      error_message("{file: a.obj, role: target, crs: 'EPSG:25832', place: {heading_deg: 1}}"),
      HasSubstr("key prior[0].crs conflicts with place"));
  EXPECT_THAT(error_message("{file: a.obj, role: terrain, base: terrain}"),
              HasSubstr("the base of terrain must be a number"));
  const TestFolder folder;
  geometry::write_mesh(folder.path() / "a.obj", flight::scenes::box({0, 0, 0}, {1, 1, 1}));
  const std::string file = "{file: '" + (folder.path() / "a.obj").string() + "', role: obstacle, ";
  EXPECT_THAT(error_message(file + "height: 3}"),
              HasSubstr("a.obj: height does not apply to this file"));
  EXPECT_THAT(error_message(file + "spacing: 0}"), HasSubstr("key prior[0].spacing is 0"));
  EXPECT_THAT(error_message("{file: a.obj, role: truth}"),
              HasSubstr("key prior[0].role: truth conflicts with scene.model"));
}

/// Returns the height of a plane with a slope of 1 in 20 to the east.
double slope(double x) { return 0.05 * x; }
geometry::Mesh hillside() {
  return {{{-100, -100, slope(-100)},
           {100, -100, slope(100)},
           {100, 100, slope(100)},
           {-100, 100, slope(-100)}},
          {{0, 1, 2}, {0, 2, 3}}};
}

TEST(PriorSurvey, UsesTerrainAsGroundOfViewsPadsAndLegs) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "hill.obj";
  geometry::write_mesh(file, hillside());
  const config::MissionSetup mission = config::parse_mission(
      flight_mission("prior: [{file: '" + file.string() + "', role: terrain, uncertainty: 0.2}]\n"),
      "m.yaml", {{"--set", "flight.takeoff", "[-75, 0, -3.75]"}});
  EXPECT_NEAR(mission.flight().ground_at({40, 10}), slope(40), 1e-9);
  EXPECT_EQ(mission.flight().ground_at({400, 10}), -3.75) << "beyond it, at the pad's height";

  const survey::ViewLimits& limits = mission.survey().planner.limits;
  const auto allows = [&](double x, double z) {
    return limits.allow(geometry::look_at({x, 0, z}, {0, 0, 5}));
  };
  const double clearance = std::stod(mission.text("limits.ground_clearance"));
  EXPECT_TRUE(allows(40, slope(40) + clearance + 0.01));
  EXPECT_FALSE(allows(40, slope(40) + clearance - 0.01));
  EXPECT_TRUE(allows(-40, slope(-40) + clearance + 0.01)) << "lower than the scene's base";
  // For any azimuth, the view of a target is high enough above the terrain at its own position.
  for (double azimuth = 0.0; azimuth < 6.28; azimuth += 0.1) {
    const auto view = limits.make_target_view(
        {0, 0, 3}, Vector3d(std::cos(azimuth), std::sin(azimuth), -0.2).normalized(), 30);
    ASSERT_TRUE(view);
    EXPECT_GE(view->position.z(), slope(view->position.x()) + clearance);
  }

  const flight::KnownSpace space(mission.flight().rules());
  const Vector3d position(50, 20, slope(50) + 6.0);
  const double true_distance = 6.0 * std::cos(std::atan(0.05));
  EXPECT_NEAR(space.distance(position, 100), true_distance - 0.2, 1e-6);
  EXPECT_EQ(space.distance({300, 0, -5}, 100), 0.0) << "beyond it, solid up to the pad's height";

  const session::SurveyRecord record = simulation::run_survey(
      mission.simulation, evaluation::SurveyScene(mission.simulation, "", 0), 1, 1);
  ASSERT_GT(record.views.size(), 3U);
  for (const session::ExecutedLeg& leg : record.flight_record->legs) {
    for (const Vector3d& point : leg.points) {
      EXPECT_GE((point.z() - slope(point.x())) * std::cos(std::atan(0.05)), 2.0 + 0.2);
    }
  }
}

/// Returns the mission without its scene and scene box.
std::string live_mission(const std::string& prior) {
  std::string text = flight_mission(prior);
  const std::string scene = "scene: {model: 'builtin:teapot', longest_side: 20.0, ground: true}\n";
  const std::string box = "  scene_box: {min: [-14, -11, 0.3], max: [14, 11, 13]}\n";
  text.erase(text.find(scene), scene.size());
  text.erase(text.find(box), box.size());
  return text;
}

TEST(PriorSurvey, DerivesSceneBoxFromTarget) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "house.obj";
  geometry::write_mesh(file, flight::scenes::box({-5, -4, 0}, {5, 4, 6}));
  const std::string prior = "prior: [{file: '" + file.string() + "', role: target}]\n";
  const config::MissionSetup mission = config::parse_mission(live_mission(prior), "m.yaml");
  const AlignedBox3d box = mission.survey().planner.scene_box.value();
  EXPECT_TRUE(box.min().isApprox(Vector3d(-5 - 3, -4 - 3, 1.2)));
  EXPECT_TRUE(box.max().isApprox(Vector3d(5 + 3, 4 + 3, 6 + 3)));
  const auto surface = mission.survey().planner.prior_surface();
  ASSERT_TRUE(surface);
  for (std::size_t i = 0; i < surface->size(); ++i) {
    EXPECT_GT(surface->positions[i].z(), 0.0F) << "nobody sees a house from below";
  }
}

// Without a pad, heights relative to it are undefined.
TEST(PriorSurvey, RequiresPadForTakeoffHeights) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "house.geojson";
  std::ofstream(file)
      << R"({"type":"Polygon","coordinates":[[[7,47],[7.0001,47],[7.0001,47.0001],[7,47]]]})";
  std::string text = flight_mission("prior: [{file: '" + file.string() +
                                    "', role: obstacle, vertical: takeoff, base: 0, height: 9}]\n");
  const std::string its_pad = "takeoff: [-75, 0, 0],";
  text.erase(text.find(its_pad), its_pad.size());
  const auto read = [&](const std::vector<config::KeyOverride>& overrides) {
    return config::parse_mission(text, "m.yaml", overrides);
  };
  const config::KeyOverride latitude{"--set", "site.latitude_deg", "47"},
      longitude{"--set", "site.longitude_deg", "7"},
      pad{"--set", "flight.takeoff", "[-75, 0, -3.75]"};
  EXPECT_THAT(testing_support::thrown_message([&] {
                read({latitude, longitude});
              }),
              HasSubstr("vertical: takeoff requires flight.takeoff"));
  const config::MissionSetup mission = read({latitude, longitude, pad});
  EXPECT_NEAR(mission.scene().priors->priors[0].box.min().z(), -3.75, 1e-3);
}

// With only a map of the house, the simulation uses the map as ground truth and reports this.
TEST(PriorSurvey, UsesTargetsAsGroundTruthInSimulation) {
  const TestFolder folder;
  geometry::write_mesh(folder.path() / "house.obj", flight::scenes::box({-5, -4, 0}, {5, 4, 6}));
  std::ofstream(folder.path() / "m.yaml")
      << live_mission("prior: [{file: house.obj, role: target}]\n");
  const std::string path = folder.path().string();
  const auto rejected = run_skycap("plan " + path + "/m.yaml --quiet --out " + path + "/none");
  EXPECT_NE(rejected.exit_code, 0);
  EXPECT_THAT(rejected.err, HasSubstr("--use-prior-as-truth"));
  const auto plan = run_skycap("plan " + path +
                               "/m.yaml --use-prior-as-truth --set flight.vehicle=none "
                               "--out " +
                               path + "/dry");
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_THAT(plan.out, HasSubstr("prior data of the targets, used as ground truth"));
  const json summary = json::parse(read_content(folder.path() / "dry" / "summary.json"));
  EXPECT_EQ(summary.at("settings").at("scene.model"), "prior");
  ASSERT_EQ(summary.at("targets").size(), 1U);
  const json& target = summary.at("targets")[0];
  // Four walls and a roof.
  EXPECT_NEAR(target.at("area_m2").get<double>(), 2 * (10 * 6 + 8 * 6) + 10 * 8, 1e-6);
  EXPECT_GT(target.at("coverage").get<double>(), 0.9);
  EXPECT_NEAR(target.at("within_m").get<double>(), 0.6 + 0.3, 1e-9);
}

// Known case: if only the roof of a house has been measured, the roof is covered.
TEST(TargetCoverage, ComputesMeasuredFractionOfObject) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "house.obj";
  geometry::write_mesh(file, flight::scenes::box({0, 0, 0}, {10, 10, 10}));
  const config::MissionSetup mission = config::parse_mission(
      flight_mission("prior: [{file: '" + file.string() + "', role: target, uncertainty: 0.1}]\n"),
      "m.yaml");
  std::vector<Eigen::Vector3f> roof;
  for (float x = 0.0F; x <= 10.0F; x += 0.25F) {
    for (float y = 0.0F; y <= 10.0F; y += 0.25F) roof.emplace_back(x, y, 10.0F);
  }
  const auto coverage =
      package::target_coverage(mission.scene(), mission.evaluation().registration_distance, roof);
  ASSERT_EQ(coverage.size(), 1U);
  // The roof, and the parts of the walls within 0.7 m of it.
  EXPECT_NEAR(coverage[0].object.covered, (100.0 + 40.0 * 0.7) / 500.0, 0.01);
  EXPECT_THAT(package::target_text(coverage), HasSubstr("of 500 m^2"));
}

}  // namespace
}  // namespace skycap::missions
