#include "missions/cli/console.h"

#include <chrono>

#include <fmt/format.h>

namespace skycap::missions::cli {
namespace {

double seconds_now() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

ProgressMode mode_of(const Console& console, bool is_quiet) {
  if (is_quiet) return ProgressMode::none;
  const bool is_shown = console.progress == ProgressMode::plain ||
                        (console.progress == ProgressMode::automatic && console.err_is_terminal);
  return is_shown ? console.progress : ProgressMode::none;
}

}  // namespace

ProgressLine::ProgressLine(const Console& console, bool is_quiet)
    : err_(console.err), mode_(mode_of(console, is_quiet)) {}

void ProgressLine::show(const std::string& text) {
  if (mode_ == ProgressMode::none) return;
  clock_.hear(text, seconds_now());
  const std::string line = printable_line(text) + clock_.rate_text();
  if (mode_ == ProgressMode::plain) {
    if (clock_.is_due())
      err_ << fmt::format("[{:.0f} s] {}\n", clock_.elapsed(), line) << std::flush;
    return;
  }
  err_ << "\r" << line << "\033[K" << std::flush;
  has_text_ = true;
}

void ProgressLine::clear() {
  if (has_text_) err_ << "\r\033[K" << std::flush;
  has_text_ = false;
}

}  // namespace skycap::missions::cli
