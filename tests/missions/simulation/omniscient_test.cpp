#include "missions/simulation/omniscient.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "missions/evaluation/coverage.h"
#include "missions/simulation/survey_runner.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using tests::quick_mission;

constexpr simulation::OmniscientConfig quick{
    .candidates = 200, .samples = 1500, .target_coverage = {}};

TEST(OracleSurvey, NeedsFewerViewsThanPlannerForSameCoverage) {
  const config::MissionSetup mission = config::parse_mission(
      quick_mission("seed: 3\n"), "m.yaml", {{"--planner", "planner.name", "skycap"}});
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const session::SurveyRecord planned = simulation::run_survey(mission.simulation, scene, 3, 1);
  // With so few candidates, the last targets are found only by chance.
  simulation::OmniscientConfig config = quick;
  config.candidates = 600;
  config.target_coverage = 0.95 * planned.coverage();
  const session::SurveyRecord known =
      simulation::survey_omnisciently(mission.simulation, scene, 3, 1, config);
  const auto reached = std::ranges::find_if(planned.views, [&](const session::EvaluatedView& view) {
    return view.coverage >= *config.target_coverage;
  });
  EXPECT_LE(known.views.size(), reached - planned.views.begin() + 1);
  // The tour has another order of views, so other points are discarded as too close. The last view
  // may also exceed the target.
  EXPECT_GE(known.coverage(), *config.target_coverage - 0.03);
}

TEST(OracleSurvey, StartsAtPlannerStartAndKeepsLimits) {
  const config::MissionSetup mission =
      config::parse_mission(quick_mission("site: {min_height: 0.3}\n"), "m.yaml");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const session::SurveyRecord record =
      simulation::survey_omnisciently(mission.simulation, scene, 1, 1, quick);
  EXPECT_EQ(record.views.front().surveyed.view.position, scene.first_view(1).position);
  for (const session::EvaluatedView& evaluated : record.views) {
    EXPECT_GE(evaluated.surveyed.view.position.z(), 0.3);
  }
  evaluation::CoverageMeter meter(scene.samples().points,
                                  mission.evaluation().registration_distance);
  meter.add(record.cloud.positions);
  EXPECT_EQ(record.coverage(), meter.share());
  EXPECT_GT(record.coverage(), 0.5);
}

TEST(OracleSurvey, IsSameForAnyThreadCount) {
  const config::MissionSetup mission = config::parse_mission(quick_mission(), "m.yaml");
  const evaluation::SurveyScene scene(mission.simulation, "", 0);
  const session::SurveyRecord one =
      simulation::survey_omnisciently(mission.simulation, scene, 2, 1, quick);
  const session::SurveyRecord three =
      simulation::survey_omnisciently(mission.simulation, scene, 2, 3, quick);
  EXPECT_EQ(one.cloud.positions, three.cloud.positions);
  EXPECT_EQ(one.distance(), three.distance());
}

TEST(OracleSurvey, EndsAtViewLimit) {
  const config::MissionSetup mission =
      config::parse_mission(quick_mission(), "m.yaml", {{"--max-views", "limits.max_views", "2"}});
  const session::SurveyRecord record = simulation::survey_omnisciently(
      mission.simulation, evaluation::SurveyScene(mission.simulation, "", 0), 1, 1, quick);
  EXPECT_EQ(record.views.size(), 2U);
  EXPECT_EQ(record.stop_reason, survey::StopReason::view_limit);
}

}  // namespace
}  // namespace skycap::missions
