#include "missions/simulation/feasibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "missions/simulation/expectation.h"
#include "missions/simulation/planning_time.h"
#include "missions/simulation/survey_runner.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::flight_mission;
using tests::quick_mission;
using tests::run_skycap;
using tests::TestFolder;

using Settings = std::vector<std::pair<std::string, std::string>>;

std::vector<config::KeyOverride> overrides(const Settings& settings) {
  std::vector<config::KeyOverride> overrides;
  for (const auto& [key, value] : settings) overrides.push_back({"--set", key, value});
  return overrides;
}

simulation::Feasibility of(const std::string& text, const Settings& settings) {
  const config::MissionSetup mission = config::parse_mission(text, "m.yaml", overrides(settings));
  return simulation::feasibility(
      mission.simulation, evaluation::SurveyScene(mission.simulation, "", 0), {.threads = 2});
}

TEST(Feasibility, FindsNoProblemsInFeasibleMissions) {
  for (const std::string& text : {quick_mission(), flight_mission()}) {
    const simulation::Feasibility found = of(text, {});
    EXPECT_THAT(found.problems, IsEmpty());
    EXPECT_THAT(found.warnings, IsEmpty());
  }
}

struct Flaw {
  Settings settings;
  std::string sentence;  ///< part of the expected sentence
};

const std::string box_min = "planner.scene_box.min", box_max = "planner.scene_box.max";

TEST(Feasibility, ReportsInfeasibleSettings) {
  const std::vector<Flaw> flaws{
      {{{"limits.stand_off", "100"}},
       "limits.stand_off (100 m) must be smaller than the view dist"},
      {{{"scene.longest_side", "5000"}}, "in millimetres, set scene.scale: 0.001"},
      {{{"scene.longest_side", "0.05"}}, "must be at least twice evaluation.coverage_distance"},
      {{{"sensor.max_range", "0.1"}}, "the maximum range of the sensor (0.1 m)"},
      {{{"sensor.min_range", "50"}}, "the minimum range of the sensor (50 m)"},
      {{{box_min, "[8, 8, 8]"}, {box_max, "[9, 9, 9]"}},
       "contains no part of the model, which extends"},
      {{{"limits.ground_clearance", "50"}}, "no part of the model is visible"},
      {{{"start.position", "[0, 3, 1]"}, {"start.look_at", "[0, 6, 1]"}},
       "the first scan contains no point of the scene; start from a view that sees it"}};
  for (const Flaw& flaw : flaws) {
    EXPECT_THAT(of(quick_mission(), flaw.settings).problems, Contains(HasSubstr(flaw.sentence)))
        << flaw.sentence;
  }
  const Settings small_box{{"flight.unknown_box.max", "[0, 11, 13]"}};
  EXPECT_THAT(of(flight_mission(), small_box).problems,
              Contains(HasSubstr("flight.unknown_box excludes")));
}

TEST(Feasibility, WarnsAboutImplausibleSettings) {
  const std::vector<Flaw> flaws{
      {{{box_min, "[-1, -1, 0]"}, {box_max, "[0, 1, 1]"}}, "of the surface, which no survey"},
      {{{"planner.view_distance", "20"}}, "covers only part of its visible surface"},
      {{{"planner.resolution_radius", "0.1"}, {"planner.spacing", "0.06"}},
       "for gapless coverage"}};
  for (const Flaw& flaw : flaws) {
    const simulation::Feasibility found = of(quick_mission(), flaw.settings);
    EXPECT_THAT(found.warnings, Contains(HasSubstr(flaw.sentence))) << flaw.sentence;
    EXPECT_THAT(found.problems, IsEmpty()) << flaw.sentence;
  }
}

TEST(Feasibility, IsCheckedBeforeSurvey) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const std::string sentence = "limits.stand_off (100 m) must be smaller than the view distance";
  const auto checked = run_skycap({"check", mission, "--set", "limits.stand_off=100"});
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_THAT(checked.out, HasSubstr("m.yaml: cannot be surveyed"));
  EXPECT_THAT(checked.out, HasSubstr(sentence));
  for (const char* trials : {"", "2"}) {
    std::vector<std::string> arguments{"plan",  mission,       "--set", "limits.stand_off=100",
                                       "--out", folder / "out"};
    if (*trials != '\0') arguments.insert(arguments.end(), {"--trials", trials});
    const auto planned = run_skycap(arguments);
    EXPECT_EQ(planned.exit_code, 2);
    EXPECT_THAT(planned.err, HasSubstr(sentence));
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  }
}

// The survey needs at least half the predicted minimum and at most twice the predicted maximum of
// views. No exceeded limit is predicted.
TEST(Expectation, PredictsViewsWithinFactorOfTwo) {
  const config::MissionSetup mission =
      config::parse_mission(quick_mission(), "m.yaml", {{"--planner", "planner.name", "skycap"}});
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const simulation::Expectation expected =
      simulation::expectation(mission.simulation, scene, {.threads = 2});
  const std::size_t views = simulation::run_survey(mission.simulation, scene, 1, 2).views.size();
  EXPECT_GE(2 * views, expected.min_views);
  EXPECT_LE(views, 2 * expected.max_views);
  EXPECT_GT(expected.known_views, 0U);
  EXPECT_LE(expected.known_views, expected.max_views);
  EXPECT_LT(expected.min_views, expected.max_views);
  EXPECT_GT(expected.min_minutes, 0.0);
  EXPECT_GT(expected.max_time, 0.0);
  EXPECT_GT(expected.memory, 1e7);

  const config::MissionSetup limited =
      config::parse_mission(quick_mission(), "m.yaml",
                            overrides({{"limits.max_views", "3"}, {"limits.max_minutes", "1"}}));
  const simulation::Expectation at_most =
      simulation::expectation(limited.simulation, scene, {.threads = 2});
  EXPECT_EQ(at_most.max_views, 3U);
  EXPECT_LE(at_most.max_minutes, 1.0);
}

// The time of a plan is the sum of its parts. Only a vehicle's mission is flown again.
TEST(PlanningTime, AddsTimeOfEachPart) {
  const simulation::PlanningPace pace{
      .start = 2.0, .scan = 0.5, .measurement = 0.25, .visible = 4.0};
  const auto time = [&](double scans, double attainable, bool has_vehicle) {
    return simulation::planning_time(pace, {.scans = scans, .points = 0.0}, attainable,
                                     has_vehicle);
  };
  const double first = time(1.0, 0.0, false);
  EXPECT_GE(first, 6.0);
  EXPECT_DOUBLE_EQ(time(11.0, 0.0, false) - first, 10.0 * 0.5);
  EXPECT_DOUBLE_EQ(time(11.0, 3.0, false) - first, 10.0 * 0.5 + 3.0);
  EXPECT_DOUBLE_EQ(time(11.0, 0.0, true) - first, 10.0 * 0.5 + 11.0 * 0.25);
}

// The attainable coverage takes no scans if the mission permits none.
TEST(PlanningTime, MeasuresPartsOfTheMission) {
  const config::MissionSetup mission =
      config::parse_mission(quick_mission(), "m.yaml", {{"--planner", "planner.name", "skycap"}});
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const simulation::PlanningPace pace =
      simulation::measure_pace(mission.simulation, scene, {.threads = 2});
  EXPECT_GT(pace.start, 0.0);
  EXPECT_GT(pace.scan, 0.0);
  EXPECT_GT(pace.visible, 0.0);
  EXPECT_LE(pace.attainable, pace.max_attainable);
  evaluation::SimulationOptions without = mission.simulation;
  without.evaluation.attainable_views = 0;
  EXPECT_EQ(simulation::measure_pace(without, scene, {.threads = 2}).max_attainable, 0.0);
}

TEST(Expectation, EqualsViewLimitOfVolumetricPlanner) {
  const config::MissionSetup mission =
      config::parse_mission(quick_mission(), "m.yaml",
                            overrides({{"planner.name", "oa"}, {"volumetric.view_limit", "8"}}));
  const simulation::Expectation expected = simulation::expectation(
      mission.simulation, evaluation::SurveyScene(mission.simulation, "", 0), {.threads = 2});
  EXPECT_EQ(expected.min_views, 8U);
  EXPECT_EQ(expected.max_views, 8U);
}

}  // namespace
}  // namespace skycap::missions
