// Choice of the mission's views, and its predictions from the measured points.

#include "missions/package/replan/mission_choice.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/clearance.h"
#include "geometry/error.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/flight_files.h"
#include "missions/package/package.h"
#include "missions/package/replan/measured_surface.h"
#include "missions/simulation/survey_runner.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using testing::HasSubstr;

/// A finished survey of a teapot of 20 m.
struct Surveyed {
  config::MissionSetup setup = config::parse_mission(tests::flight_mission(), "m.yaml",
                                                     {{"--set", "flight.views", "fastest"}});
  evaluation::SurveyScene scene{setup.simulation, ".", 1};
  session::SurveyRecord record = simulation::run_survey(setup.simulation, scene, 1, 1);

  const flight::FlightOptions& flight() const { return setup.flight(); }

  flight::Route plan(const CapturePlan& capture_points) const {
    const session::FlightRecord& flown = *record.flight_record;
    return plan_flight(flight(), *flown.measured, flown.pad, capture_points.views,
                       capture_points.paths, flown.landing_surfaces);
  }

  MissionChoice choose(const ChoiceOptions& options, const PlanRoute& plan_tour,
                       const std::stop_token& stop = {}) const {
    const flight::KnownSpace rules(flight().rules());
    const flight::JointSpace space({record.flight_record->measured.get(), &rules});
    const std::vector<geometry::View> views = collect_views(record);
    return choose_mission(flight(), setup.survey().planner, options, *record.surface, space, views,
                          plan({views, std::vector<Polyline>(views.size())}), plan_tour, stop);
  }
};

const Surveyed& surveyed() {
  static const Surveyed survey;
  return survey;
}

/// Returns a wall of 6 m by 6 m at y = 0 that faces south, as points at a distance of 0.25 m.
geometry::PointCloud wall() {
  geometry::PointCloud cloud;
  for (int x = -12; x <= 12; ++x) {
    for (int z = 0; z <= 24; ++z) {
      cloud.positions.emplace_back(0.25F * static_cast<float>(x), 0.0F,
                                   0.25F * static_cast<float>(z));
      cloud.views.push_back(0);
    }
  }
  return cloud;
}

MeasuredSurface measured_wall() {
  const geometry::PointCloud cloud = wall();
  return {0.2, cloud, std::vector<Vector3f>(cloud.size(), -Vector3f::UnitY()), 1};
}

TEST(MeasuredSurface, DrawsTargetsFromAllPoints) {
  const auto targets = measured_wall().targets(100);
  EXPECT_LE(targets.size(), 100U);
  EXPECT_GT(targets.size(), 80U);
  for (const auto& target : targets) EXPECT_EQ(target.normal, Vector3f(-Vector3f::UnitY()));
  EXPECT_LT(targets.front().position.x(), -2.0F);
  EXPECT_GT(targets.back().position.x(), 2.0F);
}

TEST(MeasuredSurface, OccludesTargetsBehindPointsOnly) {
  const MeasuredSurface surface = measured_wall();
  const std::vector<Vector3f> targets{
      {0.0F, 0.0F, 3.0F},    // on the wall
      {0.0F, 4.0F, 3.0F},    // behind the wall
      {0.0F, 4.0F, 13.0F},   // behind the wall but above the line of sight past its top
      {0.0F, -4.0F, 3.0F}};  // in front of the wall
  EXPECT_THAT(surface.in_sight({0.0, -8.0, 3.0}, targets), testing::ElementsAre(1, 0, 1, 1));
}

TEST(MissionChoice, KeepsSurveyViewsIfNoRouteIsVerified) {
  ChoiceOptions options;
  const PlanRoute fails = [](const CapturePlan&) -> flight::Route {
    throw Error(ErrorKind::bad_config, "no verified return altitude");
  };
  const MissionChoice choice = surveyed().choose(options, fails);
  EXPECT_FALSE(choice.is_replanned);
  EXPECT_THAT(choice.reason, HasSubstr("no verified return altitude"));
  EXPECT_EQ(choice.route.capture_points.size(), choice.survey.views);
  EXPECT_EQ(choice.route.duration, choice.survey.duration);
}

TEST(MissionChoice, KeepsSurveyViewsAfterStopRequest) {
  std::stop_source stop;
  stop.request_stop();
  const PlanRoute unused = [](const CapturePlan&) -> flight::Route {
    ADD_FAILURE();
    return {};
  };
  const MissionChoice choice = surveyed().choose({}, unused, stop.get_token());
  EXPECT_FALSE(choice.is_replanned);
  EXPECT_EQ(choice.reason, "interrupted");
  EXPECT_EQ(choice.route.duration, choice.survey.duration);
}

TEST(MissionChoice, IsFastestMissionThatKeepsPredictedReflight) {
  const Surveyed& survey = surveyed();
  std::vector<Vector3f> normals;
  for (std::size_t i = 0; i < survey.record.cloud.size(); ++i) {
    const Vector3d to_view =
        survey.record.views[survey.record.cloud.views[i]].surveyed.view.position -
        survey.record.cloud.positions[i].cast<double>();
    normals.push_back(to_view.normalized().cast<float>());
  }
  const MeasuredSurface measured(survey.setup.survey().planner.spacing, survey.record.cloud,
                                 normals, 1);
  ChoiceOptions options{.measured = &measured, .keeps_reflight = true};
  const MissionChoice choice =
      survey.choose(options, [&](const CapturePlan& tour) { return survey.plan(tour); });
  ASSERT_TRUE(choice.survey.predicted_reflight && choice.replanned.predicted_reflight);
  const bool keeps =
      *choice.replanned.predicted_reflight >= *choice.survey.predicted_reflight - 0.003;
  EXPECT_EQ(choice.is_replanned, keeps && choice.replanned.duration < choice.survey.duration)
      << choice.reason;
  EXPECT_EQ(flight::min_duration(choice.route),
            choice.is_replanned ? choice.replanned.duration : choice.survey.duration);
}

}  // namespace
}  // namespace skycap::missions::package
