/// Output streams and stop requests of a command.
#pragma once

#include <atomic>
#include <csignal>
#include <functional>
#include <ostream>
#include <stop_token>
#include <string>

#include "missions/cli/printable.h"

namespace skycap::missions::cli {

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

/// Progress line on a terminal that each call overwrites. It prints nothing if the output is not a
/// terminal, and is cleared on destruction.
class ProgressLine {
 public:
  ProgressLine(const Console& console, bool is_quiet)
      : err_(console.err), is_shown_(console.err_is_terminal && !is_quiet) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  void show(const std::string& text) {
    if (!is_shown_) return;
    err_ << "\r" << printable_line(text) << "\033[K" << std::flush;
    has_text_ = true;
  }

  /// Returns a callback for show(). It must not outlive this object.
  std::function<void(const std::string&)> progress_callback() {
    return [this](const std::string& text) { show(text); };
  }

  void clear() {
    if (has_text_) err_ << "\r\033[K" << std::flush;
    has_text_ = false;
  }

 private:
  std::ostream& err_;
  bool is_shown_;
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
