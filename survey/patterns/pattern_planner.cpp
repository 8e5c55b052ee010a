#include "survey/patterns/pattern_planner.h"

#include <algorithm>
#include <utility>

#include "survey/stopwatch.h"

namespace skycap::survey::patterns {
namespace {

using geometry::View;

/// Number of times that deferred views are proposed again. Each round requires a path search for
/// every view that remains.
constexpr std::size_t max_rounds = 2;

bool is_moved(const View& choice, const View& planned) {
  return (choice.position - planned.position).norm() > 1e-9;
}

}  // namespace

PatternPlanner::PatternPlanner(PatternConfig config)
    : config_((config.validate(), std::move(config))),
      kept_(config_.spacing, config_.scene_box),
      plan_(plan_pattern(config_)) {
  for (std::size_t i = 0; i < plan_.views.size(); ++i) pending_.push_back(i);
}

std::optional<View> PatternPlanner::next_view(const geometry::ScanSpan& scan) {
  step_ = {};
  Stopwatch stopwatch(step_.times);
  step_.points_new = kept_.add(scan);
  stopwatch.lap("insert");
  if (!has_begun_) begin_at(geometry::to_view(scan.world_from_sensor));
  if (proposal_) {
    const View& choice = proposal_->choices[proposal_->next - 1];
    // The survey may take views of its own instead, such as those of its initial pattern.
    constexpr double position_share = 0.25;
    if ((scan.sensor_position() - choice.position).norm() >
        position_share * config_.view_distance) {
      pending_.push_front(proposal_->view);
    } else {
      ++flown_;
      if (is_moved(choice, plan_.views[proposal_->view])) ++moved_;
    }
    proposal_.reset();
  }
  return next_choice();
}

std::optional<View> PatternPlanner::next_alternative_view() { return next_choice(); }

/// Begins after the view at which the survey begins, if it is one of the pattern.
void PatternPlanner::begin_at(const View& first) {
  has_begun_ = true;
  constexpr double position_share = 0.05, min_cosine = 0.98;
  for (std::size_t i = 0; i < plan_.views.size(); ++i) {
    for (const View& choice : find_choices(config_, plan_.views[i])) {
      if ((choice.position - first.position).norm() > position_share * config_.view_distance ||
          choice.direction.dot(first.direction) < min_cosine) {
        continue;
      }
      ++flown_;
      if (is_moved(choice, plan_.views[i])) ++moved_;
      std::rotate(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(i),
                  pending_.end());
      pending_.pop_front();
      return;
    }
  }
}

std::optional<View> PatternPlanner::next_choice() {
  for (;;) {
    if (proposal_) {
      while (proposal_->next < proposal_->choices.size()) {
        const View& choice = proposal_->choices[proposal_->next++];
        if (!may_be_at_ || may_be_at_(choice.position)) return choice;
      }
      deferred_.push_back(proposal_->view);
      proposal_.reset();
    }
    if (pending_.empty()) {
      if (deferred_.empty() || rounds_ == max_rounds || flown_ == flown_before_round_) {
        return std::nullopt;
      }
      ++rounds_;
      flown_before_round_ = flown_;
      pending_.assign(deferred_.begin(), deferred_.end());
      deferred_.clear();
    }
    proposal_ = {pending_.front(), find_choices(config_, plan_.views[pending_.front()])};
    pending_.pop_front();
  }
}

std::optional<PatternRecord> PatternPlanner::pattern() const {
  PatternRecord record{plan_.views.size() + plan_.dropped.size(), flown_, moved_, plan_.dropped};
  for (const std::size_t view : deferred_) record.dropped.push_back(plan_.views[view]);
  return record;
}

}  // namespace skycap::survey::patterns
