#include "geometry/instruction_set.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <utility>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

InstructionSet detect_instruction_set() {
#if defined(__x86_64__)
  // These features imply all others that -march=x86-64-v3 and -v4 enable in the compiler.
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi2") ||
      !__builtin_cpu_supports("fma")) {
    return InstructionSet::baseline;
  }
  const bool is_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  return is_avx512 ? InstructionSet::avx512 : InstructionSet::avx2;
#else
  return InstructionSet::baseline;
#endif
}

std::atomic<InstructionSet> limit{InstructionSet::avx512};

}  // namespace

InstructionSet instruction_set() {
  static const InstructionSet widest = detect_instruction_set();
  return std::min(widest, limit.load(std::memory_order_relaxed));
}

void limit_instruction_set(InstructionSet widest) { limit = widest; }

void limit_instruction_set(std::string_view widest) {
  using enum InstructionSet;
  for (const auto& [name, set] :
       {std::pair("baseline", baseline), {"avx2", avx2}, {"avx512", avx512}}) {
    if (widest == name) return limit_instruction_set(set);
  }
  throw Error(ErrorKind::bad_usage, "SKYCAP_INSTRUCTION_SET is '" + std::string(widest) +
                                        "'; it must be baseline, avx2 or avx512");
}

}  // namespace skycap::geometry
