#include "missions/cli/stage_clock.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

namespace skycap::missions::cli {
namespace {

constexpr double log_period = 10.0, min_duration = 2.0;  // [s]

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::string without_numbers(const std::string& text) {
  std::string rest;
  for (const char c : text) {
    if (!is_digit(c) && c != '.') rest += c;
  }
  return rest;
}

/// Count with its total.
struct Count {
  double done = 0.0, total = 0.0;
  std::size_t end = 0;  ///< Position in the message after the total, or of the percent sign.
  bool is_percent = false, is_limit = false;  ///< is_limit: the stage may end before the total.
};

/// Returns the number that ends before a position in the message, or nullopt.
std::optional<double> number_before(const std::string& text, std::size_t end) {
  std::size_t begin = end;
  while (begin > 0 && (is_digit(text[begin - 1]) || text[begin - 1] == '.')) --begin;
  if (begin == end) return std::nullopt;
  return std::strtod(text.substr(begin, end - begin).c_str(), nullptr);
}

std::optional<Count> count_in(const std::string& text) {
  constexpr std::string_view of = " of ", at_most = "at most ";
  for (std::size_t at = text.find(of); at != std::string::npos; at = text.find(of, at + 1)) {
    const std::optional<double> done = number_before(text, at);
    std::size_t next = at + of.size();
    const bool is_limit = text.compare(next, at_most.size(), at_most) == 0;
    if (is_limit) next += at_most.size();
    if (!done || next >= text.size() || !is_digit(text[next])) continue;
    std::size_t end = next;
    while (end < text.size() && is_digit(text[end])) ++end;
    return Count{*done, std::strtod(text.c_str() + next, nullptr), end, false, is_limit};
  }
  const std::size_t percent = text.find('%');
  if (percent == std::string::npos) return std::nullopt;
  const std::size_t end = percent > 0 && text[percent - 1] == ' ' ? percent - 1 : percent;
  const std::optional<double> done = number_before(text, end);
  return done ? std::optional(Count{*done, 100.0, percent, true, false}) : std::nullopt;
}

std::string duration_text(double seconds) {
  constexpr double minute = 60.0, hour = 3600.0;
  if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 100.0 * minute) return fmt::format("{:.0f} min", seconds / minute);
  return fmt::format("{:.1f} h", seconds / hour);
}

}  // namespace

void StageClock::hear(const std::string& text, double now) {
  now_ = now;
  if (!begin_) begin_ = now;
  const std::optional<Count> count = count_in(text);
  std::string stage = without_numbers(count ? text.substr(0, count->end) : text);
  const bool goes_back = count && done_ && count->done < *done_;
  if (stage != stage_ || goes_back) {
    stage_ = std::move(stage);
    stage_begin_ = now;
    first_.reset();
    logged_.reset();
  }
  done_.reset();
  names_time_ = text.find(" left") != std::string::npos;
  if (!count) return;
  if (!first_) first_ = count->done;
  done_ = count->done;
  total_ = count->total;
  is_percent_ = count->is_percent;
  is_limit_ = count->is_limit;
}

std::string StageClock::rate_text() const {
  if (names_time_ || !done_ || !first_ || !total_) return "";
  const double duration = now_ - stage_begin_, advanced = *done_ - *first_;
  if (duration < min_duration || advanced <= 0.0 || *total_ < *done_) return "";
  const double rate = advanced / duration;
  const std::string left =
      (is_limit_ ? "at most " : "") + duration_text((*total_ - *done_) / rate) + " left";
  return is_percent_ ? ", " + left : fmt::format(", {:.2g}/s, {}", rate, left);
}

bool StageClock::is_due() {
  if (logged_ && now_ - *logged_ < log_period) return false;
  logged_ = now_;
  return true;
}

}  // namespace skycap::missions::cli
