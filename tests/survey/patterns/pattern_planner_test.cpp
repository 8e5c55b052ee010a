#include "survey/patterns/pattern_planner.h"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/pose/camera.h"
#include "survey/planners/planner_options.h"
#include "survey/survey_loop.h"

namespace skycap::survey::patterns {
namespace {

using Eigen::Vector3d;
using geometry::View;

PatternConfig config_of(Pattern pattern) {
  PatternConfig config;
  config.pattern = pattern;
  config.view_distance = 10.0;
  config.max_distance = 40.0;
  config.footprint = {8.0, 6.0};
  config.target = target_of(Eigen::AlignedBox3d(Vector3d(-8, -5, 0), Vector3d(8, 5, 9)));
  return config;
}

geometry::Scan scan_at(const View& view) {
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose(view);
  return scan;
}

/// Surveys with a planner from a first view; `can_reach` may be empty.
SurveyResult fly(PatternPlanner& planner, const View& first,
                 std::function<bool(const Vector3d&, const View&)> can_reach = {},
                 std::vector<View> initial = {}) {
  SurveyCallbacks callbacks;
  callbacks.initial_pattern = std::move(initial);
  callbacks.sense = [](const View& view, geometry::Scan) { return scan_at(view); };
  callbacks.can_reach = std::move(can_reach);
  return run_survey(planner, first, {}, callbacks);
}

TEST(PatternPlanner, FliesAllViewsInOrder) {
  for (const Pattern pattern : {Pattern::nadir, Pattern::oblique, Pattern::dome, Pattern::facade,
                                Pattern::rings, Pattern::corridor}) {
    const PatternConfig config = config_of(pattern);
    const std::vector<View> planned = plan_pattern(config).views;
    PatternPlanner planner(config);
    const SurveyResult survey = fly(planner, planned.front());
    EXPECT_EQ(survey.stop_reason, StopReason::complete);
    ASSERT_EQ(survey.views.size(), planned.size()) << to_string(pattern);
    for (std::size_t i = 0; i < planned.size(); ++i) {
      EXPECT_EQ(survey.views[i].view.position, planned[i].position);
    }
    const PatternRecord record = planner.pattern().value();
    EXPECT_EQ(record.flown, planned.size());
    EXPECT_EQ(record.planned, planned.size());
    EXPECT_EQ(record.moved, 0U);
    EXPECT_TRUE(record.dropped.empty());
  }
}

TEST(PatternPlanner, BeginsInTheMiddleOfThePattern) {
  const PatternConfig config = config_of(Pattern::rings);
  const std::vector<View> planned = plan_pattern(config).views;
  PatternPlanner planner(config);
  const SurveyResult survey = fly(planner, planned[5]);
  ASSERT_EQ(survey.views.size(), planned.size());
  EXPECT_EQ(survey.views[1].view.position, planned[6].position);
  EXPECT_EQ(survey.views.back().view.position, planned[4].position);
}

TEST(PatternPlanner, FliesPatternAfterViewsOfTheSurveyItself) {
  const PatternConfig config = config_of(Pattern::rings);
  const std::vector<View> planned = plan_pattern(config).views;
  PatternPlanner planner(config);
  const View elsewhere{{100, 0, 50}, {-1, 0, 0}};
  const SurveyResult survey =
      fly(planner, elsewhere, {}, {{{100, 10, 50}, {-1, 0, 0}}, {{100, 20, 50}, {-1, 0, 0}}});
  EXPECT_EQ(survey.views.size(), planned.size() + 3);
  EXPECT_EQ(planner.pattern().value().flown, planned.size());
}

TEST(PatternPlanner, MovesAwayFromWhatIsInTheWay) {
  const PatternConfig config = config_of(Pattern::rings);
  // A tree of 1 m stands at the first view.
  const std::vector<View> planned = plan_pattern(config).views;
  const Vector3d tree = planned.front().position;
  PatternPlanner planner(config);
  const SurveyResult survey = fly(planner, planned[3], [&](const Vector3d&, const View& view) {
    return (view.position - tree).head<2>().norm() > 1.0;
  });
  const PatternRecord record = planner.pattern().value();
  EXPECT_EQ(survey.views.size(), planned.size());
  EXPECT_GE(record.moved, 1U);
  EXPECT_TRUE(record.dropped.empty());
  for (const SurveyedView& view : survey.views) {
    EXPECT_GT((view.view.position - tree).head<2>().norm(), 1.0);
  }
}

TEST(PatternPlanner, DropsUnreachableViewsAndListsThem) {
  const PatternConfig config = config_of(Pattern::nadir);
  const std::vector<View> planned = plan_pattern(config).views;
  const auto is_free = [](const Vector3d&, const View& view) { return view.position.x() < 3.0; };
  PatternPlanner planner(config);
  const SurveyResult survey = fly(planner, planned.front(), is_free);
  const PatternRecord record = planner.pattern().value();
  std::size_t expected = 0;
  for (const View& view : planned) expected += view.position.x() < 3.0 ? 1 : 0;
  EXPECT_EQ(survey.views.size(), expected);
  EXPECT_EQ(record.flown, expected);
  EXPECT_EQ(record.dropped.size(), planned.size() - expected);
  for (const View& view : record.dropped) EXPECT_GE(view.position.x(), 3.0);
}

TEST(PatternPlanner, FliesDeferredViewsOnceTheyAreFree) {
  const PatternConfig config = config_of(Pattern::nadir);
  const std::vector<View> planned = plan_pattern(config).views;
  // The first row is free only after the sensor has been beyond it.
  double seen_to = -1e9;
  const auto is_free = [&](const Vector3d& from, const View& view) {
    seen_to = std::max(seen_to, from.x());
    return view.position.x() > -5.0 || seen_to > 3.0;
  };
  PatternPlanner planner(config);
  const SurveyResult survey = fly(planner, planned[planned.size() / 2], is_free);
  EXPECT_EQ(survey.views.size(), planned.size());
  EXPECT_TRUE(planner.pattern().value().dropped.empty());
}

TEST(PatternPlanner, IsMadeWithGrantedTarget) {
  PlannerOptions options;
  options.name = PlannerName::facade;
  PatternConfig config = config_of(Pattern::facade);
  const PatternTarget target = *config.target;
  config.target.reset();
  options.method = config;
  EXPECT_THROW(make_planner(options, {}), std::exception);
  const auto planner = make_planner(options, {.pattern_target = target});
  EXPECT_GT(planner->pattern().value().planned, 20U);
  EXPECT_EQ(pattern_of(PlannerName::nadir), Pattern::nadir);
  EXPECT_EQ(pattern_of(PlannerName::corridor), Pattern::corridor);
  EXPECT_FALSE(pattern_of(PlannerName::external));
  EXPECT_FALSE(pattern_of(PlannerName::random));
}

}  // namespace
}  // namespace skycap::survey::patterns
