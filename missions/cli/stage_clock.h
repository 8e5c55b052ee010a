/// How fast the stages of a command advance, read from their progress texts.
#pragma once

#include <optional>
#include <string>

namespace skycap::missions::cli {

class StageClock {
 public:
  /// Takes in a progress text at `now` [s]. A text with another wording, numbers and what follows
  /// "N of M" or "N%" aside, begins a stage.
  void hear(const std::string& text, double now);

  /// Rate and remaining time, such as ", 2.5/s, 40 s left": of "N of M" in the text heard last, or
  /// of "N%". Empty before the stage has advanced for two seconds, for texts without such numbers
  /// and for those that name a remaining time themselves.
  std::string rate_text() const;

  /// Whether a log should have a line now: the stage is new, or ten seconds have passed since
  /// the last line. Counts as a line if so.
  bool is_due();

  /// Since the first text [s].
  double elapsed() const { return now_ - begin_.value_or(now_); }

 private:
  std::string stage_;                           ///< the text without its numbers
  std::optional<double> begin_;                 ///< of everything [s]
  std::optional<double> logged_;                ///< when the last line was due [s]
  double now_ = 0.0;                            ///< [s]
  double stage_begin_ = 0.0;                    ///< [s]
  std::optional<double> first_, done_, total_;  ///< counts: at the stage's begin, now, at its end
  bool names_time_ = false, is_percent_ = false;
};

}  // namespace skycap::missions::cli
