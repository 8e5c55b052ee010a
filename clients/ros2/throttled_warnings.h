/// Rate-limited warnings about messages, one line each.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>

namespace skycap::ros2 {

/// Returns the text of a message field. Null gives an empty string; non-printable characters become
/// question marks.
std::string printable_text(const char* text);

class ThrottledWarnings {
 public:
  /// `report` receives complete lines.
  explicit ThrottledWarnings(std::function<void(const std::string&)> report)
      : report_(std::move(report)) {}

  /// Reports `line`, unless a warning of the same kind was reported within the five seconds before
  /// `now` [s]. Suppressed warnings are counted, and the next report contains their number. Returns
  /// true if reported.
  bool add(const std::string& kind, const std::string& line, double now);

  std::size_t count() const { return count_; }  ///< Number of warnings, including suppressed ones.
  const std::string& last() const { return last_; }

 private:
  struct Kind {
    double reported_at = 0.0;
    std::size_t suppressed = 0;
  };
  std::function<void(const std::string&)> report_;
  std::map<std::string, Kind> kinds_;
  std::size_t count_ = 0;
  std::string last_;
};

}  // namespace skycap::ros2
