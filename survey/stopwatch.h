/// Measures the time of the parts of a planner update.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

#include "survey/planner.h"

namespace skycap::survey {

/// Adds `seconds` to the time of `part`, which is appended if it is new.
inline void add_time(std::vector<PartTime>& times, const char* part, double seconds) {
  const auto known = std::ranges::find(times, part, &PartTime::part);
  if (known == times.end()) {
    times.push_back({part, seconds});
  } else {
    known->seconds += seconds;
  }
}

class Stopwatch {
 public:
  explicit Stopwatch(std::vector<PartTime>& times) : times_(times) {}

  /// Adds the time since the last call, or since construction, to the time of `part`.
  void lap(const char* part) {
    const auto now = std::chrono::steady_clock::now();
    add_time(times_, part, std::chrono::duration<double>(now - last_).count());
    last_ = now;
  }

 private:
  std::vector<PartTime>& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace skycap::survey
