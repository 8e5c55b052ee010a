/// Adds limits to a planner that does not support them. Rejects its proposals until one of them is
/// within the limits.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

#include "geometry/points/point_grid.h"
#include "survey/planner.h"
#include "survey/view_limits.h"

namespace skycap::survey {

class LimitedPlanner final : public Planner {
 public:
  LimitedPlanner(std::unique_ptr<Planner> planner, const ViewLimits& limits);

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  void pass(const geometry::ScanSpan& scan) override { planner_->pass(scan); }
  std::optional<geometry::View> next_alternative_view() override;
  void keep_to(PositionCheck may_be_at) override { planner_->keep_to(std::move(may_be_at)); }
  bool allows(const geometry::View& view) override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override { return planner_->cloud(); }
  geometry::PointCloud take_cloud() override { return planner_->take_cloud(); }
  const PlanningStep& last_step() const override { return step_; }
  StopReason stop_reason() const override;
  const CoverageEstimator* estimator() const override { return planner_->estimator(); }
  std::optional<PatternRecord> pattern() const override { return planner_->pattern(); }

 private:
  std::optional<geometry::View> within_limits(std::optional<geometry::View> view);

  std::unique_ptr<Planner> planner_;
  ViewLimits limits_;
  geometry::PointGrid measured_;  ///< cloud of the planner, only if the limits have a stand-off
  std::size_t points_known_ = 0;
  PlanningStep step_;
  std::stop_token stop_;
  bool has_rejected_ = false;  ///< a proposal was rejected since the last next_view()
};

}  // namespace skycap::survey
