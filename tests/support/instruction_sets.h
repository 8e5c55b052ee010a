/// Runs tests with each vector instruction set.
#pragma once

#include <vector>

#include "geometry/instruction_set.h"

namespace skycap {

/// Returns the instruction sets of this processor, from the narrowest to the widest.
inline std::vector<geometry::InstructionSet> instruction_sets() {
  using enum geometry::InstructionSet;
  std::vector<geometry::InstructionSet> all;
  for (const auto set : {baseline, avx2, avx512}) {
    if (set <= geometry::instruction_set()) all.push_back(set);
  }
  return all;
}

/// Limits the process to one instruction set during the lifetime of the object.
class InstructionSetLimit {
 public:
  explicit InstructionSetLimit(geometry::InstructionSet widest)
      : before_(geometry::instruction_set()) {
    geometry::limit_instruction_set(widest);
  }
  InstructionSetLimit(const InstructionSetLimit&) = delete;
  InstructionSetLimit& operator=(const InstructionSetLimit&) = delete;
  ~InstructionSetLimit() { geometry::limit_instruction_set(before_); }

 private:
  geometry::InstructionSet before_;
};

}  // namespace skycap
