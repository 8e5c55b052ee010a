#include "survey/limited_planner.h"

#include <algorithm>
#include <span>
#include <utility>

namespace skycap::survey {

using geometry::View;

LimitedPlanner::LimitedPlanner(std::unique_ptr<Planner> planner, const ViewLimits& limits)
    : planner_(std::move(planner)),
      limits_(limits),
      measured_(std::max(limits.min_standoff, 1e-3)) {}

std::optional<View> LimitedPlanner::next_view(const geometry::ScanSpan& scan) {
  has_rejected_ = false;
  std::optional<View> view = planner_->next_view(scan);
  step_ = planner_->last_step();
  return within_limits(std::move(view));
}

std::optional<View> LimitedPlanner::next_alternative_view() {
  return within_limits(planner_->next_alternative_view());
}

void LimitedPlanner::stop_on(const std::stop_token& stop) {
  stop_ = stop;
  planner_->stop_on(stop);
}

StopReason LimitedPlanner::stop_reason() const {
  return has_rejected_ ? StopReason::nowhere_to_go : planner_->stop_reason();
}

bool LimitedPlanner::allows(const View& view) {
  if (!limits_.allow(view)) return false;
  if (limits_.min_standoff == 0.0) return true;
  const std::span points(planner_->cloud().positions);
  for (const Eigen::Vector3f& point : points.subspan(points_known_)) measured_.insert(point);
  points_known_ = points.size();
  return !measured_.any_within(view.position.cast<float>(), limits_.min_standoff);
}

std::optional<View> LimitedPlanner::within_limits(std::optional<View> view) {
  while (view && !allows(*view)) {
    if (stop_.stop_requested()) throw Interrupted();
    has_rejected_ = true;
    view = planner_->next_alternative_view();
  }
  return view;
}

}  // namespace skycap::survey
