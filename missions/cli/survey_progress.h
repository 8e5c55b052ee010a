/// How far many surveys are.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// A line that says how many surveys are done and how long the rest will take, from the mean
/// duration of surveys of the same kind (a mission and its planner), or of any where none of that
/// kind is over yet. May be told from several threads.
class SurveyProgress {
 public:
  /// `verb` begins the line; `threads` surveys run at a time.
  SurveyProgress(std::string verb, const Console& console, bool is_quiet, unsigned threads);

  void say(const std::string& text);
  void expect(const std::string& kind, std::size_t surveys);
  void expect_no_more(const std::string& kind);  ///< one of them was done before
  void survey_done(const std::string& kind, double seconds);
  void clear();

 private:
  struct Kind {
    std::size_t left = 0, done = 0;
    double seconds = 0.0;
  };

  double work_left() const;

  std::string verb_;
  ProgressLine line_;
  double threads_;
  std::mutex mutex_;
  std::size_t total_ = 0;
  Kind of_any_;
  std::map<std::string, Kind> kinds_;
};

}  // namespace skycap::missions::cli
