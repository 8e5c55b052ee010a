#include <memory>
#include <utility>

#include <skycap/survey/planner.h>

#include "example.h"

namespace {

class ScanTwice final : public skycap::survey::Planner {
 public:
  std::optional<skycap::geometry::View> next_view(const skycap::geometry::ScanSpan&) override {
    if (++scans_ == 2) return std::nullopt;
    return skycap::geometry::look_at({0, -6, 3}, {0, 0, 1});
  }
  std::optional<skycap::geometry::View> next_alternative_view() override { return std::nullopt; }
  const skycap::geometry::PointCloud& cloud() const override { return cloud_; }
  skycap::geometry::PointCloud take_cloud() override { return std::move(cloud_); }
  const skycap::survey::PlanningStep& last_step() const override { return step_; }

 private:
  int scans_ = 0;
  skycap::geometry::PointCloud cloud_;
  skycap::survey::PlanningStep step_;
};

}  // namespace

// A custom planner in Skycap's survey loop.
const Example planner_example("survey/planner", [] {
  const std::unique_ptr<skycap::survey::Planner> planner = std::make_unique<ScanTwice>();
  const auto next = planner->next_view(skycap::geometry::Scan());
  return next && !planner->next_view(skycap::geometry::Scan());
});
