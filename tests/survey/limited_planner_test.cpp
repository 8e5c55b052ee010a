#include "survey/limited_planner.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "survey/survey_loop.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3f;
using geometry::Scan;
using geometry::View;
using testing::ElementsAre;

View view_at(double x, double z) { return {{x, 0, z}, {1, 0, 0}}; }

/// Planner that proposes the views of a list in order. After a rejection it proposes the next one.
class ListPlanner final : public Planner {
 public:
  explicit ListPlanner(std::vector<View> views) : views_(std::move(views)) {}

  std::optional<View> next_view(const geometry::ScanSpan& scan) override {
    cloud_.positions.insert(cloud_.positions.end(), scan.points.begin(), scan.points.end());
    step_ = {.points_new = scan.points.size()};
    return next();
  }
  std::optional<View> next_alternative_view() override {
    step_ = {};
    return next();
  }
  void pass(const geometry::ScanSpan& scan) override { passed_ += scan.points.size(); }
  void keep_to(PositionCheck may_be_at) override { may_be_at_ = std::move(may_be_at); }
  const geometry::PointCloud& cloud() const override { return cloud_; }
  geometry::PointCloud take_cloud() override { return std::move(cloud_); }
  const PlanningStep& last_step() const override { return step_; }

  std::size_t passed() const { return passed_; }
  bool may_be_at(const Eigen::Vector3d& position) const { return may_be_at_(position); }

 private:
  std::optional<View> next() {
    if (proposed_ == views_.size()) return std::nullopt;
    return views_[proposed_++];
  }

  std::vector<View> views_;
  std::size_t proposed_ = 0, passed_ = 0;
  PositionCheck may_be_at_;
  geometry::PointCloud cloud_;
  PlanningStep step_;
};

/// All tests limit the height, except those of the stand-off.
const ViewLimits two_to_four{.min_height = 2.0, .max_height = 4.0};

std::unique_ptr<ListPlanner> planner_at_heights(const std::vector<double>& heights) {
  std::vector<View> views;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    views.push_back(view_at(static_cast<double>(i + 1), heights[i]));
  }
  return std::make_unique<ListPlanner>(std::move(views));
}

Scan make_scan(const std::vector<Vector3f>& points) {
  return {.world_from_sensor = geometry::camera_pose(view_at(0, 3)), .points = points};
}

const Scan scan = make_scan({{0, 0, 0}, {0, 0, 1}});

TEST(LimitedPlanner, ProposesOnlyViewsWithinLimits) {
  LimitedPlanner planner(planner_at_heights({1, 3, 5, 9, 2, 4, 6}), two_to_four);
  std::vector<double> heights;
  for (auto view = planner.next_view(scan); view; view = planner.next_view(scan)) {
    EXPECT_TRUE(two_to_four.allow(*view));
    heights.push_back(view->position.z());
  }
  EXPECT_THAT(heights, ElementsAre(3, 2, 4));
}

TEST(LimitedPlanner, ProposesOnlyAlternativeViewsWithinLimits) {
  LimitedPlanner planner(planner_at_heights({3, 5, 1, 2, 6}), two_to_four);
  EXPECT_EQ(planner.next_view(scan)->position.z(), 3.0);
  EXPECT_EQ(planner.next_alternative_view()->position.z(), 2.0);
  EXPECT_FALSE(planner.next_alternative_view());
}

// The points of a scan count from that scan on, and earlier points count as well.
TEST(LimitedPlanner, KeepsStandOffFromAllMeasuredPoints) {
  auto list = std::make_unique<ListPlanner>(std::vector<View>{
      view_at(2.9, 0), view_at(3.1, 0), view_at(3.1, 0), view_at(-0.9, 0), view_at(-1.1, 0)});
  LimitedPlanner planner(std::move(list), {.min_standoff = 1.0});
  EXPECT_EQ(planner.next_view(make_scan({{2, 0, 0}}))->position.x(), 3.1);
  EXPECT_EQ(planner.next_view(make_scan({{4, 0, 0}, {0, 0, 0}}))->position.x(), -1.1);
  EXPECT_FALSE(planner.allows(view_at(2.9, 0)));
  EXPECT_TRUE(planner.allows(view_at(-1.1, 0)));
}

TEST(LimitedPlanner, StopsWithNowhereToGoWhenAllViewsAreRejected) {
  LimitedPlanner planner(planner_at_heights({1, 5, 3}), two_to_four);
  ASSERT_TRUE(planner.next_view(scan));
  EXPECT_FALSE(planner.next_alternative_view());
  EXPECT_EQ(planner.stop_reason(), StopReason::nowhere_to_go);
  // The planner proposed no more views, so none was rejected.
  EXPECT_FALSE(planner.next_view(scan));
  EXPECT_EQ(planner.stop_reason(), StopReason::complete);
}

TEST(LimitedPlanner, EndsSurveyWithReasonOfItsLimits) {
  const auto sense = [](const View& view, const Scan&) {
    return Scan{.world_from_sensor = geometry::camera_pose(view), .points = {{0, 0, 0}}};
  };
  LimitedPlanner rejected(planner_at_heights({3, 5, 1}), two_to_four);
  const SurveyResult result = run_survey(rejected, view_at(0, 3), {}, {.sense = sense});
  EXPECT_EQ(result.stop_reason, StopReason::nowhere_to_go);
  EXPECT_EQ(result.views.size(), 2U);
  LimitedPlanner done(planner_at_heights({5, 3}), two_to_four);
  EXPECT_EQ(run_survey(done, view_at(0, 3), {}, {.sense = sense}).stop_reason,
            StopReason::complete);
}

// An initial pattern does not come from the planner, but the survey limits apply to it.
TEST(LimitedPlanner, SkipsInitialPatternViewsOutsideLimits) {
  const auto sense = [](const View& view, const Scan&) {
    return Scan{.world_from_sensor = geometry::camera_pose(view), .points = {{0, 0, 0}}};
  };
  LimitedPlanner planner(planner_at_heights({}), two_to_four);
  const SurveyResult result = run_survey(
      planner, view_at(0, 3), {},
      {.initial_pattern = {view_at(1, 5), view_at(2, 4), view_at(3, 1)}, .sense = sense});
  ASSERT_EQ(result.views.size(), 2U);
  EXPECT_LT((result.views[1].view.position - view_at(2, 4).position).norm(), 1e-12);
}

// The step belongs to the last scan, even if the planner then searches for other views.
TEST(LimitedPlanner, KeepsStepOfLastScan) {
  LimitedPlanner planner(planner_at_heights({1, 5, 3, 2}), two_to_four);
  ASSERT_TRUE(planner.next_view(scan));
  EXPECT_EQ(planner.last_step().points_new, 2U);
  ASSERT_TRUE(planner.next_alternative_view());
  EXPECT_EQ(planner.last_step().points_new, 2U);
}

TEST(LimitedPlanner, StopsWhilePlanningView) {
  LimitedPlanner planner(planner_at_heights({1, 5, 3}), two_to_four);
  std::stop_source stop;
  planner.stop_on(stop.get_token());
  stop.request_stop();
  EXPECT_THROW(planner.next_view(scan), Interrupted);
}

TEST(LimitedPlanner, ForwardsCallsToPlanner) {
  auto list = planner_at_heights({3});
  const ListPlanner& inside = *list;
  LimitedPlanner planner(std::move(list), two_to_four);
  ASSERT_TRUE(planner.next_view(scan));
  planner.pass(scan);
  EXPECT_EQ(inside.passed(), 2U);
  EXPECT_EQ(planner.cloud().size(), 2U);
  planner.keep_to([](const Eigen::Vector3d& position) { return position.x() > 0.0; });
  EXPECT_TRUE(inside.may_be_at({1, 0, 0}));
  EXPECT_FALSE(inside.may_be_at({-1, 0, 0}));
  EXPECT_EQ(planner.take_cloud().size(), 2U);
}

}  // namespace
}  // namespace skycap::survey
