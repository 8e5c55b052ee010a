/// Survey by a standard pattern instead of a planner, as ground stations offer them.
///
/// The target is known beforehand: from the mission, or granted by the simulated scene. Views are
/// taken in the order of the pattern. A view that cannot be reached is moved away from what it
/// faces, or deferred until the end, when more space is known to be free.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "survey/kept_points.h"
#include "survey/patterns/pattern_config.h"
#include "survey/planner.h"

namespace skycap::survey::patterns {

class PatternPlanner final : public Planner {
 public:
  /// Throws the errors of config.validate() and plan_pattern().
  explicit PatternPlanner(PatternConfig config);

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  void pass(const geometry::ScanSpan& scan) override { kept_.add(scan); }
  std::optional<geometry::View> next_alternative_view() override;
  void keep_to(PositionCheck may_be_at) override { may_be_at_ = std::move(may_be_at); }
  const geometry::PointCloud& cloud() const override { return kept_.cloud(); }
  geometry::PointCloud take_cloud() override { return kept_.take(); }
  const PlanningStep& last_step() const override { return step_; }
  std::optional<PatternRecord> pattern() const override;

 private:
  /// View of the pattern and its choices that were not proposed yet.
  struct Proposal {
    std::size_t view = 0;
    std::vector<geometry::View> choices{};
    std::size_t next = 0;
  };

  void begin_at(const geometry::View& first);
  std::optional<geometry::View> next_choice();

  PatternConfig config_;
  KeptPoints kept_;
  PlannedPattern plan_;
  std::deque<std::size_t> pending_;    ///< Views to propose, in order.
  std::vector<std::size_t> deferred_;  ///< Views that could not be reached in this round.
  std::optional<Proposal> proposal_;
  std::size_t flown_ = 0, moved_ = 0;
  std::size_t flown_before_round_ = 0;
  std::size_t rounds_ = 0;
  bool has_begun_ = false;
  PositionCheck may_be_at_;
  PlanningStep step_;
};

}  // namespace skycap::survey::patterns
