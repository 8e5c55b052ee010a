/// Rate and remaining time of a command's stages, derived from its progress messages.
#pragma once

#include <optional>
#include <string>

namespace skycap::missions::cli {

class StageClock {
 public:
  /// Processes a progress message received at `now` [s]. A message with different wording starts a
  /// new stage. Numbers and the text after "N of M" or "N%" are not compared.
  void hear(const std::string& text, double now);

  /// Returns the rate and remaining time, such as ", 2.5/s, 40 s left", computed from "N of M" or
  /// "N%" in the latest message. For "N of at most M", the time is an upper bound. Returns an empty
  /// string during the first two seconds of a stage, and for messages without such numbers or with
  /// a remaining time of their own.
  std::string rate_text() const;

  /// Returns true if the log requires a line now: at the start of a stage, and ten seconds after
  /// the previous line. Records the time of the line in this case.
  bool is_due();

  /// Returns the time since the first message [s].
  double elapsed() const { return now_ - begin_.value_or(now_); }

 private:
  std::string stage_;             ///< Message without its numbers.
  std::optional<double> begin_;   ///< Time of the first message [s].
  std::optional<double> logged_;  ///< Time of the latest log line [s].
  double now_ = 0.0;              ///< Time of the latest message [s].
  double stage_begin_ = 0.0;      ///< Start of the stage [s].
  std::optional<double> first_, done_,
      total_;  ///< Counts at the start of the stage, now, and at its end.
  bool names_time_ = false, is_percent_ = false, is_limit_ = false;
};

}  // namespace skycap::missions::cli
