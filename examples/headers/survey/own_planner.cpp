#include <memory>

#include <skycap/survey/own_planner.h>

#include "example.h"

namespace {

class ScanTwice final : public skycap::survey::OwnPlanner {
 public:
  explicit ScanTwice(const skycap::survey::OwnPlannerTask& task) : distance_(task.view_distance) {}

  std::optional<skycap::geometry::View> next_view(const skycap::geometry::ScanSpan&,
                                                  const skycap::geometry::PointCloud&) override {
    if (++scans_ == 2) return std::nullopt;
    return skycap::geometry::View{{0.0, -distance_, 1.0}, {0.0, 1.0, 0.0}};
  }

 private:
  double distance_;
  int scans_ = 0;
};

}  // namespace

SKYCAP_OWN_PLANNER(ScanTwice)

// The two functions that skycap calls after it has loaded the library of a planner.
const Example own_planner_example("survey/own_planner", [] {
  const skycap::survey::OwnPlannerTask task{.view_distance = 6.0};
  const std::unique_ptr<skycap::survey::OwnPlanner> planner(
      static_cast<skycap::survey::OwnPlanner*>(skycap_make_own_planner(&task)));
  const skycap::geometry::Scan scan;
  const auto next = planner->next_view(scan, {});
  return skycap_own_planner_interface() == 1 && next && next->position.y() == -6.0 &&
         !planner->next_view(scan, {});
});
