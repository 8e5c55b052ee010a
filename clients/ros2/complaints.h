/// What is wrong with messages, in a line each and not too often.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>

namespace skycap::ros2 {

/// A string of a message: null is empty, and what no terminal should see is a question mark.
std::string text_of(const char* text);

class Complaints {
 public:
  /// `say` is given whole lines.
  explicit Complaints(std::function<void(const std::string&)> say) : say_(std::move(say)) {}

  /// Says `line`, unless something of its kind was said in the five seconds before `now`; then it
  /// is counted, and the count said with the next. Whether it was said.
  bool add(const std::string& kind, const std::string& line, double now);

  std::size_t count() const { return count_; }  ///< said or not
  const std::string& last() const { return last_; }

 private:
  struct Kind {
    double said_at = 0.0;
    std::size_t unsaid = 0;
  };
  std::function<void(const std::string&)> say_;
  std::map<std::string, Kind> kinds_;
  std::size_t count_ = 0;
  std::string last_;
};

}  // namespace skycap::ros2
