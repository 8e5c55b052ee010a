/// Survey without planning: a set of views on a sphere, fixed after the first scan. Reference for
/// planners: a planner is worth its effort if it needs fewer views or a shorter path.
///
/// It is granted the centroid and the size of the true surface and the positions that the true
/// scene admits. No other planner except the oracle knows them.
#pragma once

#include <optional>
#include <vector>

#include "survey/fixed_views/fixed_views_config.h"
#include "survey/kept_points.h"
#include "survey/planner.h"

namespace skycap::survey::fixed_views {

class FixedViewPlanner final : public Planner {
 public:
  /// Throws the errors of config.validate().
  explicit FixedViewPlanner(FixedViewsConfig config);

  /// Throws the errors of make_view_set() for the first scan.
  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_alternative_view() override;
  const geometry::PointCloud& cloud() const override { return kept_.cloud(); }
  geometry::PointCloud take_cloud() override { return kept_.take(); }
  const PlanningStep& last_step() const override { return step_; }

 private:
  FixedViewsConfig config_;
  KeptPoints kept_;
  std::vector<geometry::View> views_;  ///< in the order in which they are taken
  std::size_t next_ = 0;
  PlanningStep step_;
};

}  // namespace skycap::survey::fixed_views
