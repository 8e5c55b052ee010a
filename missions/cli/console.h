/// Output streams and stop requests of a command.
#pragma once

#include <atomic>
#include <csignal>
#include <functional>
#include <ostream>
#include <stop_token>
#include <string>

#include "missions/cli/printable.h"
#include "missions/cli/stage_clock.h"

namespace skycap::missions::cli {

/// How progress is shown: in one line on a terminal and otherwise not, as lines for a log, or
/// never.
enum class ProgressMode { automatic, plain, none };

/// Interface between a command and its environment, which tests can replace.
struct Console {
  std::ostream& out;             ///< stream for results
  std::ostream& err;             ///< stream for progress, warnings and errors
  bool err_is_terminal = false;  ///< whether to show progress in a single rewritten line
  std::stop_token stop = {};     ///< stop request, set by Ctrl-C
  /// Number of PendingResultsGuard objects. While it is zero, Ctrl-C ends the program immediately.
  std::atomic<int>* results_held = nullptr;
  const std::atomic<int>* termination_signal =
      nullptr;  ///< signal that requested the stop, or zero
  ProgressMode progress = ProgressMode::automatic;
};

/// Prints a one-line warning. The command continues.
inline void warn(const Console& console, const std::string& what) {
  console.err << "skycap: warning: " << printable_line(what) << "\n" << std::flush;
}

/// Returns the exit code of an interrupted command: 128 + SIGTERM after SIGTERM, otherwise 1.
inline int interrupted_exit_code(const Console& console) {
  const bool is_ended = console.termination_signal && *console.termination_signal == SIGTERM;
  return is_ended ? 128 + SIGTERM : 1;
}

/// Marks a scope with unsaved results that Ctrl-C must not discard. Within this scope the command
/// monitors Console::stop and saves its results within two seconds of a request.
class PendingResultsGuard {
 public:
  explicit PendingResultsGuard(const Console& console) : count_(console.results_held) {
    if (count_ != nullptr) ++*count_;
  }
  PendingResultsGuard(const PendingResultsGuard&) = delete;
  PendingResultsGuard& operator=(const PendingResultsGuard&) = delete;
  ~PendingResultsGuard() {
    if (count_ != nullptr) --*count_;
  }

 private:
  std::atomic<int>* count_;
};

/// One line on a terminal that each call overwrites; cleared when it goes out of scope. With plain
/// progress, lines that stay: one at the beginning of each stage and one every ten seconds, with
/// the time since the beginning. Nothing without either. To "N of M" and "N%" both add the rate and
/// the remaining time of the stage, as far as it can be told: from its speed so far.
class ProgressLine {
 public:
  ProgressLine(const Console& console, bool is_quiet);
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  void show(const std::string& text);

  /// Returns a callback for show(). It must not outlive this object.
  std::function<void(const std::string&)> progress_callback() {
    return [this](const std::string& text) { show(text); };
  }

  void clear();

 private:
  std::ostream& err_;
  ProgressMode mode_;
  StageClock clock_;
  bool has_text_ = false;
};

/// Reads a command's mission with `read`, such as config::read_mission(), and shows the progress.
/// Reading may be slow for missions with large prior data.
template <class Read, class Options>
auto read_shown(const Read& read, const Options& options, const Console& console) {
  bool is_quiet = false;
  if constexpr (requires { options.is_quiet; }) is_quiet = options.is_quiet;
  ProgressLine progress(console, is_quiet);
  return read(options.mission, options.overrides, progress.progress_callback());
}

}  // namespace skycap::missions::cli
