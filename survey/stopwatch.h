/// Splits the time of a planner's update into its parts.
#pragma once

#include <chrono>
#include <vector>

#include "survey/planner.h"

namespace skycap::survey {

class Stopwatch {
 public:
  /// Fills `times` from its beginning.
  explicit Stopwatch(std::vector<PartTime>& times) : times_(times) { times_.clear(); }

  /// Books the time since the last call, or since construction, under `part`.
  void lap(const char* part) {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back({part, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  std::vector<PartTime>& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace skycap::survey
