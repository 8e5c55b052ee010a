#include "survey/survey_loop.h"

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using geometry::Scan;
using geometry::View;
using testing::ElementsAre;

/// Planner that proposes x = 1, 2, 3, ... up to a last position. After a rejection it proposes the
/// next one.
class WalkingPlanner final : public Planner {
 public:
  explicit WalkingPlanner(int last) : last_(last) {}
  std::optional<View> next_view(const geometry::ScanSpan& scan) override {
    cloud_.positions.insert(cloud_.positions.end(), scan.points.begin(), scan.points.end());
    return walk_on();
  }
  std::optional<View> next_alternative_view() override { return walk_on(); }
  void pass(const geometry::ScanSpan& scan) override {
    passed.push_back(scan.sensor_position().x());
  }
  const geometry::PointCloud& cloud() const override { return cloud_; }
  geometry::PointCloud take_cloud() override { return std::move(cloud_); }
  const PlanningStep& last_step() const override { return step_; }

  std::vector<double> passed;  ///< Positions of the en-route scans.

 private:
  std::optional<View> walk_on() {
    if (at_ == last_) return std::nullopt;
    return View{{static_cast<double>(++at_), 0, 0}, {1, 0, 0}};
  }
  int at_ = 0, last_;
  geometry::PointCloud cloud_;
  PlanningStep step_;
};

const View start{{0, 0, 0}, {1, 0, 0}};

/// Simulates a sensor that reaches each view and returns two points.
Scan sense(const View& view, const Scan& = {}) {
  return {.world_from_sensor = geometry::camera_pose(view), .points = {{0, 0, 0}, {1, 1, 1}}};
}

std::vector<double> positions(const SurveyResult& result) {
  std::vector<double> x;
  for (const SurveyedView& view : result.views) x.push_back(view.view.position.x());
  return x;
}

TEST(SurveyLoop, ContinuesUntilPlannerIsComplete) {
  WalkingPlanner planner(3);
  const SurveyResult result = run_survey(planner, start, {}, {.sense = sense});
  EXPECT_EQ(result.stop_reason, StopReason::complete);
  EXPECT_THAT(positions(result), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(result.views.back().points, 8U);
  EXPECT_EQ(result.views.back().returns, 2U);
}

// Trap T10: the distance starts at the first view and is measured along straight segments.
TEST(SurveyLoop, MeasuresDistanceFromFirstView) {
  WalkingPlanner planner(2);
  const SurveyResult result = run_survey(planner, {{-5, 0, 0}, {1, 0, 0}}, {}, {.sense = sense});
  EXPECT_EQ(result.views[0].distance, 0.0);
  EXPECT_EQ(result.views[1].distance, 6.0);
  EXPECT_EQ(result.views[2].distance, 7.0);
}

TEST(SurveyLoop, StopsAtLimits) {
  WalkingPlanner first(100);
  const SurveyResult views = run_survey(first, start, {.max_views = 4}, {.sense = sense});
  EXPECT_EQ(views.stop_reason, StopReason::view_limit);
  EXPECT_THAT(positions(views), ElementsAre(0, 1, 2, 3));
  WalkingPlanner second(100);
  const SurveyResult distance = run_survey(second, start, {.max_distance = 2.5}, {.sense = sense});
  EXPECT_EQ(distance.stop_reason, StopReason::distance_limit);
  EXPECT_THAT(positions(distance), ElementsAre(0, 1, 2));
  // The third view ends after 17 s (3 x 5 s and 2 m at 1 m/s), a fourth would end after 23 s.
  WalkingPlanner third(100);
  const SurveyResult time =
      run_survey(third, start, {.max_time = 20.0, .speed = 1.0}, {.sense = sense});
  EXPECT_EQ(time.stop_reason, StopReason::time_limit);
  EXPECT_THAT(positions(time), ElementsAre(0, 1, 2));
}

// The planner receives each en-route scan before the scan of the view, and the survey lists them.
TEST(SurveyLoop, GivesEnRouteScansToThePlanner) {
  WalkingPlanner planner(2);
  const auto halfway = [](const View& from, const View& to) {
    return std::vector{View{0.5 * (from.position + to.position), to.direction}};
  };
  const SurveyResult result = run_survey(
      planner, start, {}, {.sense = sense, .en_route_views = halfway, .sense_en_route = sense});
  EXPECT_THAT(planner.passed, ElementsAre(0.5, 1.5));
  ASSERT_EQ(result.views.size(), 3U);
  EXPECT_TRUE(result.views[0].en_route.views.empty());
  ASSERT_EQ(result.views[2].en_route.views.size(), 1U);
  EXPECT_EQ(result.views[2].en_route.views[0].position.x(), 1.5);
  EXPECT_EQ(result.views[2].en_route.returns, 2U);
}

TEST(SurveyLoop, RequestsAlternativeForUnreachableView) {
  WalkingPlanner planner(4);
  const auto odd_positions_only = [](const Vector3d&, const View& to) {
    return static_cast<int>(to.position.x()) % 2 == 1;
  };
  const SurveyResult result =
      run_survey(planner, start, {}, {.sense = sense, .can_reach = odd_positions_only});
  EXPECT_THAT(positions(result), ElementsAre(0, 1, 3));
  EXPECT_EQ(result.stop_reason, StopReason::nowhere_to_go);  // 4 was proposed and rejected
}

// The initial pattern comes first. Its unreachable views are skipped, and the planner continues.
TEST(SurveyLoop, FliesInitialPatternBeforePlannedViews) {
  WalkingPlanner planner(4);
  const auto view_at = [](double x) { return View{{x, 0, 0}, {1, 0, 0}}; };
  const auto not_at_eleven = [](const Vector3d&, const View& to) { return to.position.x() != 11; };
  const SurveyResult result =
      run_survey(planner, start, {},
                 {.initial_pattern = {view_at(10), view_at(11), view_at(12)},
                  .sense = sense,
                  .can_reach = not_at_eleven});
  // The planner was called after each scan of the initial pattern. Its proposals 1 and 2 were not
  // used.
  EXPECT_THAT(positions(result), ElementsAre(0, 10, 12, 3, 4));
  EXPECT_EQ(result.stop_reason, StopReason::complete);
}

/// Planner that takes 2 ms for a view and 5 ms for an alternative. It accounts for half of the
/// former.
class SlowPlanner final : public Planner {
 public:
  std::optional<View> next_view(const geometry::ScanSpan&) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    step_.times = {{"think", 0.001}};
    return walk_on();
  }
  std::optional<View> next_alternative_view() override {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return walk_on();
  }
  const geometry::PointCloud& cloud() const override { return cloud_; }
  geometry::PointCloud take_cloud() override { return std::move(cloud_); }
  const PlanningStep& last_step() const override { return step_; }

 private:
  std::optional<View> walk_on() {
    return at_ == 6 ? std::nullopt : std::optional(View{{double(++at_), 0, 0}, {1, 0, 0}});
  }
  int at_ = 0;
  geometry::PointCloud cloud_;
  PlanningStep step_;
};

// Also for rejected views, either by the loop itself or by the function that moves the sensor.
TEST(SurveyLoop, SplitsPlanningTimeWithoutRemainder) {
  const auto far_only = [](const Vector3d&, const View& to) { return to.position.x() >= 3; };
  SlowPlanner planner;
  SurveyStepper steps(planner, {}, {.can_reach = far_only});
  ASSERT_TRUE(steps.add_scan(sense(start)));
  ASSERT_TRUE(steps.reject());
  const SurveyedView& taken = steps.views().back();
  double sum = 0.0;
  std::vector<std::string> parts;
  for (const PartTime& time : taken.step.times) {
    sum += time.seconds;
    parts.push_back(time.part);
  }
  EXPECT_THAT(parts, ElementsAre("think", "rest", "instead"));
  EXPECT_NEAR(sum, taken.planning_time, 1e-12);
  EXPECT_GE(taken.step.times[1].seconds, 0.001);
  EXPECT_GE(taken.step.times[2].seconds, 0.015);  // 1 and 2 rejected by the loop, 3 by the caller
}

TEST(SurveyLoop, StopsBetweenViewsOnRequest) {
  WalkingPlanner planner(100);
  std::stop_source stop;
  const SurveyResult result = run_survey(planner, start, {},
                                         {.sense = sense,
                                          .report =
                                              [&](const SurveyedView& view, const Scan&) {
                                                if (view.view.position.x() == 2)
                                                  stop.request_stop();
                                              }},
                                         stop.get_token());
  EXPECT_EQ(result.stop_reason, StopReason::interrupted);
  EXPECT_THAT(positions(result), ElementsAre(0, 1, 2));
}

/// Planner that is stopped while it plans from its third scan.
class StoppedPlanner final : public Planner {
 public:
  std::optional<View> next_view(const geometry::ScanSpan& scan) override {
    const std::optional<View> next = walking_.next_view(scan);
    if (++scans_ == 3) source.request_stop();
    if (stop_.stop_requested()) throw Interrupted();
    return next;
  }
  std::optional<View> next_alternative_view() override { return walking_.next_alternative_view(); }
  void stop_on(const std::stop_token& stop) override { stop_ = stop; }
  const geometry::PointCloud& cloud() const override { return walking_.cloud(); }
  geometry::PointCloud take_cloud() override { return walking_.take_cloud(); }
  const PlanningStep& last_step() const override { return walking_.last_step(); }

  std::stop_source source;

 private:
  WalkingPlanner walking_{100};
  std::stop_token stop_;
  int scans_ = 0;
};

TEST(SurveyLoop, StopsWhilePlanningView) {
  StoppedPlanner planner;
  const SurveyResult result =
      run_survey(planner, start, {}, {.sense = sense}, planner.source.get_token());
  EXPECT_EQ(result.stop_reason, StopReason::interrupted);
  EXPECT_THAT(positions(result), ElementsAre(0, 1));
}

// After a stop request, no further views are requested once there is a view to return.
TEST(SurveyLoop, StopsWhileViewsAreRejected) {
  WalkingPlanner planner(1'000'000'000);
  std::stop_source source;
  std::stop_token reported;
  const auto near_only = [&](const Vector3d&, const View& to) {
    if (to.position.x() == 100.0) source.request_stop();
    return to.position.x() < 3.0;
  };
  const SurveyResult result =
      run_survey(planner, start, {},
                 {.sense = sense,
                  .can_reach = near_only,
                  .stop_on = [&](std::stop_token stop) { reported = std::move(stop); }},
                 source.get_token());
  EXPECT_EQ(result.stop_reason, StopReason::interrupted);
  EXPECT_THAT(positions(result), ElementsAre(0, 1));
  EXPECT_TRUE(reported.stop_requested());
}

TEST(SurveyLoop, StopsAtTimeLimit) {
  WalkingPlanner planner(100);
  // 1 m of path and 1 s for each view: positions 0, 1 and 2 take 5 s.
  const SurveyResult result = run_survey(
      planner, start, {.max_time = 5.5, .speed = 1.0, .time_per_view = 1.0}, {.sense = sense});
  EXPECT_EQ(result.stop_reason, StopReason::time_limit);
  EXPECT_THAT(positions(result), ElementsAre(0, 1, 2));
}

TEST(SurveyLoop, ReturnsScanBuffersForReuse) {
  WalkingPlanner planner(2);
  std::vector<const void*> taken, returned;
  const auto reusing_buffer = [&](const View& view, Scan buffer) {
    returned.push_back(buffer.points.empty() ? nullptr : buffer.points.data());
    buffer.world_from_sensor = geometry::camera_pose(view);
    buffer.points.resize(2, Eigen::Vector3f::Zero());
    taken.push_back(buffer.points.data());
    return buffer;
  };
  run_survey(planner, start, {}, {.sense = reusing_buffer});
  EXPECT_THAT(returned, ElementsAre(nullptr, taken[0], taken[1]));
}

// A real drone stops where the wind allows. The reported pose is used.
TEST(SurveyLoop, UsesPoseThatSensorReached) {
  WalkingPlanner planner(1);
  const auto drift = [](const View& view, const Scan&) {
    return sense({view.position + Vector3d(0, 0.5, 0), view.direction});
  };
  const SurveyResult result = run_survey(planner, start, {}, {.sense = drift});
  EXPECT_EQ(result.views[1].view.position, Vector3d(1, 0.5, 0));
}

}  // namespace
}  // namespace skycap::survey
