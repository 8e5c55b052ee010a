/// Where a verb writes to, and how it is asked to stop.
#pragma once

#include <atomic>
#include <csignal>
#include <functional>
#include <ostream>
#include <stop_token>
#include <string>

#include "missions/cli/printable.h"

namespace skycap::missions::cli {

/// The program's surroundings, so that tests can put themselves in their place.
struct Console {
  std::ostream& out;             ///< results
  std::ostream& err;             ///< progress, warnings and errors
  bool err_is_terminal = false;  ///< whether progress is shown, in one line that is rewritten
  std::stop_token stop = {};     ///< requested by Ctrl-C
  /// How many HoldsResults there are. While there is none, Ctrl-C ends the program at once.
  std::atomic<int>* results_held = nullptr;
  const std::atomic<int>* ending_signal = nullptr;  ///< that requested the stop; zero before
};

/// Says what is amiss, in one line, where the verb goes on all the same.
inline void warn(const Console& console, const std::string& what) {
  console.err << "skycap: warning: " << printable_line(what) << "\n" << std::flush;
}

/// What a shell says of a program that a signal has ended, or 1.
inline int interrupted_exit_code(const Console& console) {
  const bool is_ended = console.ending_signal && *console.ending_signal == SIGTERM;
  return is_ended ? 128 + SIGTERM : 1;
}

/// While it lives, the verb has results that Ctrl-C must not lose: it watches Console::stop and
/// brings them to the disk within two seconds.
class HoldsResults {
 public:
  explicit HoldsResults(const Console& console) : count_(console.results_held) {
    if (count_ != nullptr) ++*count_;
  }
  HoldsResults(const HoldsResults&) = delete;
  HoldsResults& operator=(const HoldsResults&) = delete;
  ~HoldsResults() {
    if (count_ != nullptr) --*count_;
  }

 private:
  std::atomic<int>* count_;
};

/// One line on a terminal that each call overwrites; nothing where there is no terminal. Cleared
/// when it goes out of scope.
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

  /// Shows what it is told. Not for longer than the line lives.
  std::function<void(const std::string&)> teller() {
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

/// The mission that a verb is given, by config::read_mission() or one like it. Where that takes
/// long, since there is much prior data, it shows how far it is.
template <class Read, class Options>
auto read_shown(const Read& read, const Options& options, const Console& console) {
  bool is_quiet = false;
  if constexpr (requires { options.is_quiet; }) is_quiet = options.is_quiet;
  ProgressLine progress(console, is_quiet);
  return read(options.mission, options.overrides, progress.teller());
}

}  // namespace skycap::missions::cli
