#include "survey/fixed_views/fixed_view_planner.h"

#include <utility>

#include "geometry/error.h"
#include "survey/fixed_views/view_set.h"
#include "survey/stopwatch.h"

namespace skycap::survey::fixed_views {
namespace {

std::vector<geometry::View> make_ordered_views(const FixedViewsConfig& config,
                                               const Eigen::Vector3d& start) {
  const std::vector<geometry::View> set = make_view_set(config);
  std::vector<Eigen::Vector3d> positions;
  for (const geometry::View& view : set) positions.push_back(view.position);
  std::vector<geometry::View> ordered;
  for (const std::size_t i : config.settings.order == ViewOrder::tour
                                 ? compute_tour(start, positions)
                                 : compute_spread(start, positions)) {
    ordered.push_back(set[i]);
  }
  return ordered;
}

}  // namespace

FixedViewPlanner::FixedViewPlanner(FixedViewsConfig config)
    : config_((config.validate(), std::move(config))), kept_(config_.spacing, config_.scene_box) {}

std::optional<geometry::View> FixedViewPlanner::next_view(const geometry::ScanSpan& scan) {
  step_ = {};
  Stopwatch stopwatch(step_.times);
  const bool is_first = kept_.scans() == 0;
  step_.points_new = kept_.add(scan);
  stopwatch.lap("insert");
  if (kept_.cloud().positions.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "the first scan contains no point of the scene; start from a view that sees it, or "
                "enlarge planner.scene_box");
  }
  if (is_first) {
    views_ = make_ordered_views(config_, scan.sensor_position());
    stopwatch.lap("tour");
  }
  return next_alternative_view();
}

std::optional<geometry::View> FixedViewPlanner::next_alternative_view() {
  return next_ < views_.size() ? std::optional(views_[next_++]) : std::nullopt;
}

}  // namespace skycap::survey::fixed_views
