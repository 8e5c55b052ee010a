#include "geometry/instruction_set.h"

#include <algorithm>
#include <atomic>

namespace skycap::geometry {
namespace {

InstructionSet widest_of_processor() {
#if defined(__x86_64__)
  // What -march=x86-64-v3 and -v4 let the compiler use, of which these imply the rest.
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
  static const InstructionSet widest = widest_of_processor();
  return std::min(widest, limit.load(std::memory_order_relaxed));
}

void limit_instruction_set(InstructionSet widest) { limit = widest; }

}  // namespace skycap::geometry
