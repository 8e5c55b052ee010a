#include "missions/cli/survey_progress.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace skycap::missions::cli {

SurveyProgress::SurveyProgress(std::string verb, const Console& console, bool is_quiet,
                               unsigned threads)
    : verb_(std::move(verb)), line_(console, is_quiet), threads_(threads) {}

void SurveyProgress::say(const std::string& text) {
  const std::lock_guard lock(mutex_);
  line_.show(text);
}

void SurveyProgress::expect(const std::string& kind, std::size_t surveys) {
  const std::lock_guard lock(mutex_);
  total_ += surveys;
  kinds_[kind].left += surveys;
}

void SurveyProgress::expect_no_more(const std::string& kind) {
  const std::lock_guard lock(mutex_);
  --total_;
  --kinds_[kind].left;
}

void SurveyProgress::survey_done(const std::string& kind, double seconds) {
  const std::lock_guard lock(mutex_);
  Kind& own = kinds_[kind];
  if (own.left > 0) --own.left;
  for (Kind* known : {&own, &of_any_}) {
    known->seconds += seconds;
    ++known->done;
  }
  const auto minutes = static_cast<int>(std::ceil(work_left() / threads_ / 60.0));
  line_.show(fmt::format("{}: {} of {} surveys, about {} min left; {}", verb_, of_any_.done, total_,
                         minutes, kind));
}

void SurveyProgress::clear() {
  const std::lock_guard lock(mutex_);
  line_.clear();
}

double SurveyProgress::work_left() const {
  double work = 0.0;
  for (const auto& [name, kind] : kinds_) {
    const Kind& known = kind.done > 0 ? kind : of_any_;
    work += static_cast<double>(kind.left) * known.seconds / static_cast<double>(known.done);
  }
  return work;
}

}  // namespace skycap::missions::cli
